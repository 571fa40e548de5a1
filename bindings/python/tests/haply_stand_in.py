"""A stand-in for Haply's service: an Inverse3 of 0.2 kg with damping that no hand holds, over a WebSocket of the standard library alone."""

import base64
import hashlib
import json
import socket
import struct
import threading
import time

STEP = 1e-3
MASS_KG, DAMPING_N_S_PER_M = 0.2, 2.5


class HaplyService:
    """Listens at ``address``. ``last_n`` is the last commanded force; ``gone`` ends the service as if unplugged."""

    def __init__(self):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.last_n, self.commands, self.gone = [0.0] * 3, 0, False
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self):
        while True:
            stream, _ = self.listener.accept()
            stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            asked = b""
            while b"\r\n\r\n" not in asked:
                asked += stream.recv(4096)
            if asked.startswith(b"GET /version"):
                body = b'{"version":"3.5.1"}'
                stream.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
                stream.close()
            else:
                self._speak(stream, asked)
                return

    def _speak(self, stream, asked):
        key = next(line.split(b":")[1].strip() for line in asked.split(b"\r\n") if line.lower().startswith(b"sec-websocket-key"))
        accept = base64.b64encode(hashlib.sha1(key + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest())
        stream.sendall(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: " + accept + b"\r\n\r\n")
        place, speed = [0.05, -0.2, 0.1], [0.0] * 3
        with stream:
            while not self.gone:
                entry = {
                    "device_id": "049D",
                    "state": {"cursor_position": dict(zip("xyz", place))},
                    "status": {"calibrated": True, "ready": True, "power_supply": True},
                }
                text = json.dumps({"inverse3": [entry]}).encode()
                stream.sendall(b"\x81\x7e" + struct.pack(">H", len(text)) + text)
                time.sleep(0.9 * STEP)
                said = self._frame(stream)
                if said is None:
                    return
                force = json.loads(said)["inverse3"][0]["commands"]["set_cursor_force"]["vector"]
                self.last_n = [force[axis] for axis in "xyz"]
                self.commands += 1
                for axis in range(3):
                    speed[axis] += (self.last_n[axis] - DAMPING_N_S_PER_M * speed[axis]) / MASS_KG * STEP
                    place[axis] += speed[axis] * STEP

    @staticmethod
    def _frame(stream):
        """The text of the next frame; None at the end."""

        def read(count):
            got = b""
            while len(got) < count:
                part = stream.recv(count - len(got))
                if not part:
                    raise EOFError
                got += part
            return got

        try:
            kind, length = read(2)
            length &= 127
            if length == 126:
                (length,) = struct.unpack(">H", read(2))
            mask, body = read(4), read(length)
        except (EOFError, OSError):
            return None
        return None if kind & 15 == 8 else bytes(byte ^ mask[at % 4] for at, byte in enumerate(body))
