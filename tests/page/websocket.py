"""A minimal WebSocket client (RFC 6455): text messages in both directions, for a browser's remote agent on this computer."""

import base64
import os
import select
import socket
import struct
import time


class WebSocket:
    def __init__(self, host, port, path):
        self.socket = socket.create_connection((host, port))
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f"GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        self.buffer, self.parts = b"", []
        while b"\r\n\r\n" not in self.buffer:
            self.more(20)
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise RuntimeError(f"no WebSocket: {head}")

    def more(self, limit):
        """Reads the bytes that have arrived; returns False if none arrives within `limit` seconds."""
        if not select.select([self.socket], [], [], max(0, limit))[0]:
            return False
        some = self.socket.recv(1 << 16)
        if not some:
            raise RuntimeError("the browser has gone")
        self.buffer += some
        return True

    def send(self, text, kind=1):
        data, mask = text.encode() if isinstance(text, str) else text, os.urandom(4)
        size = struct.pack("!B", 0x80 | len(data)) if len(data) < 126 else struct.pack("!BH", 0xfe, len(data)) if len(data) < 65536 else struct.pack("!BQ", 0xff, len(data))
        keys = (mask * (len(data) // 4 + 1))[:len(data)]
        masked = (int.from_bytes(data, "big") ^ int.from_bytes(keys, "big")).to_bytes(len(data), "big")
        self.socket.sendall(bytes([0x80 | kind]) + size + mask + masked)

    def frame(self):
        """Removes and returns the first complete frame: whether it ends a message, its type, and its data. None if there is no complete frame."""
        if len(self.buffer) < 2:
            return None
        size, at = self.buffer[1] & 0x7f, 2
        if size > 125:
            at = 4 if size == 126 else 10
            if len(self.buffer) < at:
                return None
            size = int.from_bytes(self.buffer[2:at], "big")
        if len(self.buffer) < at + size:
            return None
        first, data = self.buffer[0], self.buffer[at:at + size]
        self.buffer = self.buffer[at + size:]
        return first & 0x80, first & 0x0f, data

    def receive(self, limit):
        """The next message, or None after `limit` seconds."""
        end = time.monotonic() + limit
        while True:
            if (frame := self.frame()) is None:
                if not self.more(end - time.monotonic()):
                    return None
                continue
            last, kind, data = frame
            if kind == 9:
                self.send(data, 10)
            elif kind == 8:
                raise RuntimeError("the browser has gone")
            elif kind < 3:
                self.parts.append(data)
                if last:
                    text, self.parts = b"".join(self.parts).decode(), []
                    return text

    def close(self):
        self.socket.close()
