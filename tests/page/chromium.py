"""Controls Chromium by the DevTools protocol, through a pair of pipes."""

import base64
import json
import os
import select
import subprocess
import time

from browser import Page, found


def find():
    """Path of an installed Chromium, or None."""
    return found(os.environ.get("CHROMIUM"), "chromium", "chromium-browser", "google-chrome", "chrome")


class Chromium(Page):
    name = "Chromium"
    # The protocol can simulate touch, a user who asks for reduced motion, and keys that press buttons. Sound starts without a
    # sound device.
    touches = hears = stills = presses = True

    def __init__(self, url, width=1280, height=1000, downloads=None, before=None):
        super().__init__()
        self.buffer = b""
        out_read, self.write = os.pipe()
        self.read, in_write = os.pipe()

        def pipes():
            # The browser reads its commands from file descriptor 3 and answers on 4.
            read, write = os.dup(out_read), os.dup(in_write)
            os.dup2(read, 3)
            os.dup2(write, 4)

        words = [find(), "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-dev-shm-usage",
                 "--remote-debugging-pipe", f"--user-data-dir={self.profile.name}", f"--window-size={width},{height}",
                 "--autoplay-policy=no-user-gesture-required", "about:blank"]
        self.process = subprocess.Popen(words, preexec_fn=pipes, close_fds=False,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(out_read)
        os.close(in_write)
        targets = self.call("Target.getTargets", session=None)["targetInfos"]
        page = next(target for target in targets if target["type"] == "page")
        self.session = self.call("Target.attachToTarget", {"targetId": page["targetId"], "flatten": True}, session=None)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.size(width, height)
        if downloads:
            self.call("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": downloads}, session=None)
        if before:
            self.call("Page.addScriptToEvaluateOnNewDocument", {"source": before})
        self.go(url)

    def go(self, url):
        self.call("Page.navigate", {"url": url})

    def dark(self):
        self.call("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})

    def still(self):
        """Simulates a user who has asked the system for reduced motion."""
        self.call("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]})

    def size(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})

    def message(self, limit):
        """The browser's next message, or None after `limit` seconds."""
        end = time.monotonic() + limit
        while b"\0" not in self.buffer:
            ready, _, _ = select.select([self.read], [], [], max(0, end - time.monotonic()))
            if not ready:
                return None
            some = os.read(self.read, 1 << 16)
            if not some:
                raise RuntimeError("the browser has gone")
            self.buffer += some
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def note(self, message):
        """Keeps errors and warnings of the page in `problems`."""
        method, params = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.problems.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.problems.append(" ".join(str(a.get("value", a.get("description"))) for a in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            self.problems.append(params["entry"]["text"])

    def call(self, method, params=None, session="own", limit=60):
        self.number += 1
        order = {"id": self.number, "method": method, "params": params or {}}
        if session == "own":
            order["sessionId"] = self.session
        os.write(self.write, json.dumps(order).encode() + b"\0")
        while True:
            message = self.message(limit)
            if message is None:
                raise TimeoutError(method)
            if message.get("id") == order["id"]:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self.note(message)

    def run(self, script):
        """Evaluates a JavaScript expression in the page and returns its value."""
        result = self.call("Runtime.evaluate", {"expression": script, "returnByValue": True, "awaitPromise": True, "userGesture": True})
        if "exceptionDetails" in result:
            raise RuntimeError(f"{script}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def press_key(self, key, down):
        code = {"text": key} if len(key) == 1 and down else {}
        virtual = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, " ": 32, "Escape": 27}.get(key, ord(key[0].upper()))
        self.call("Input.dispatchKeyEvent", {"type": "keyDown" if down else "keyUp", "key": key, "windowsVirtualKeyCode": virtual, **code})

    def mouse(self, kind, x, y):
        """Simulates the mouse button: `kind` is `down`, `move` (with the button down) or `up`."""
        named = {"down": "mousePressed", "move": "mouseMoved", "up": "mouseReleased"}[kind]
        self.call("Input.dispatchMouseEvent", {"type": named, "x": x, "y": y, "button": "left", "clickCount": 1})

    def wheel(self, x, y, by):
        self.call("Input.dispatchMouseEvent", {"type": "mouseWheel", "x": x, "y": y, "button": "none", "deltaX": 0, "deltaY": by})

    def touch(self, kind, x, y):
        """Simulates a touch of the screen: `kind` is `start`, `move` or `end`."""
        self.call("Emulation.setTouchEmulationEnabled", {"enabled": True})
        named = {"start": "touchStart", "move": "touchMove", "end": "touchEnd"}[kind]
        self.call("Input.dispatchTouchEvent", {"type": named, "touchPoints": [] if kind == "end" else [{"x": x, "y": y}]})

    def put_file(self, element, path):
        document = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call("DOM.querySelector", {"nodeId": document, "selector": f"#{element}"})["nodeId"]
        self.call("DOM.setFileInputFiles", {"files": [path], "nodeId": node})

    def picture(self, path, whole=False):
        data = self.call("Page.captureScreenshot", {"format": "png", "captureBeyondViewport": whole, **({"clip": self.whole()} if whole else {})})
        with open(path, "wb") as file:
            file.write(base64.b64decode(data["data"]))

    def whole(self):
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        return {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}

    def close(self):
        try:
            self.call("Browser.close", session=None, limit=5)
        except Exception:
            self.process.terminate()
        self.process.wait(timeout=10)
        os.close(self.write)
        os.close(self.read)
        self.profile.cleanup()
