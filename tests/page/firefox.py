"""Controls Firefox by WebDriver BiDi through the browser's own remote agent, so that no separate driver is needed."""

import base64
import json
import os
import subprocess
import time

from browser import Page, found
from websocket import WebSocket

KEYS = {"ArrowLeft": "\ue012", "ArrowUp": "\ue013", "ArrowRight": "\ue014", "ArrowDown": "\ue015", "Escape": "\ue00c"}


def find():
    """Path of an installed Firefox, or None."""
    return found(os.environ.get("FIREFOX"), "firefox", "firefox-esr")


class Firefox(Page):
    name = "Firefox"
    touches = False
    # Firefox starts no audio without a sound device.
    hears = False
    # A page without a window never has the focus, and Firefox then lets no key press a button.
    presses = False
    # The protocol cannot simulate a user who asks for reduced motion.
    stills = False

    def __init__(self, url, width=1280, height=1000, downloads=None, before=None):
        super().__init__()
        settings = {
            "browser.shell.checkDefaultBrowser": False, "datareporting.policy.dataSubmissionEnabled": False, "app.update.enabled": False,
            "browser.startup.homepage_override.mstone": "ignore", "media.autoplay.default": 0, "network.captive-portal-service.enabled": False,
            "browser.download.folderList": 2, "browser.download.dir": downloads or "", "browser.download.always_ask_before_handling_new_types": False,
            "browser.download.alwaysOpenPanel": False, "browser.region.update.enabled": False, "app.normandy.enabled": False, "layout.css.prefers-color-scheme.content-override": 1,
            "dom.disable_open_during_load": False, "browser.tabs.remote.autostart": True, "remote.active-protocols": 1,
        }
        with open(os.path.join(self.profile.name, "user.js"), "w", encoding="ascii") as file:
            file.writelines(f"user_pref({json.dumps(name)}, {json.dumps(value)});\n" for name, value in settings.items())
        self.process = subprocess.Popen([find(), "--headless", "--no-remote", "--profile", self.profile.name, "--remote-debugging-port=0", "about:blank"],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.socket = WebSocket(*self.place(), "/session")
        self.call("session.new", {"capabilities": {"alwaysMatch": {"acceptInsecureCerts": False}}})
        self.call("session.subscribe", {"events": ["log.entryAdded"]})
        self.tab = self.call("browsingContext.getTree")["contexts"][0]["context"]
        if before:
            self.call("script.addPreloadScript", {"functionDeclaration": f"() => {{ {before} }}"})
        self.held = set()
        self.size(width, height)
        self.go(url)

    def place(self):
        """Host and port on which the browser's remote agent listens. The agent writes them into a file of the profile."""
        file = os.path.join(self.profile.name, "WebDriverBiDiServer.json")
        for _ in range(600):
            try:
                with open(file, encoding="utf-8") as told:
                    said = json.load(told)
                    return said["ws_host"], said["ws_port"]
            except (OSError, ValueError, KeyError):
                time.sleep(0.1)
        raise TimeoutError("Firefox does not listen")

    def message(self, limit):
        text = self.socket.receive(limit)
        return None if text is None else json.loads(text)

    def note(self, message):
        """Keeps errors and warnings of the page in `problems`."""
        if message.get("method") == "log.entryAdded" and message["params"]["level"] in ("error", "warn"):
            self.problems.append(message["params"].get("text") or str(message["params"]))

    def call(self, method, params=None, limit=60):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params or {}}))
        while True:
            message = self.message(limit)
            if message is None:
                raise TimeoutError(method)
            if message.get("id") == self.number:
                if message["type"] == "error":
                    raise RuntimeError(f"{method}: {message['error']}: {message['message']}")
                return message["result"]
            self.note(message)

    def go(self, url):
        self.call("browsingContext.navigate", {"context": self.tab, "url": url, "wait": "interactive"})

    def size(self, width, height):
        self.call("browsingContext.setViewport", {"context": self.tab, "viewport": {"width": width, "height": height}, "devicePixelRatio": 1})

    def dark(self):
        """Does nothing: the protocol cannot change the colour scheme of a running page, as `Chromium.dark` does."""

    def run(self, script):
        """Evaluates a JavaScript expression in the page and returns its value."""
        result = self.call("script.evaluate", {"expression": script, "target": {"context": self.tab}, "awaitPromise": True, "userActivation": True})
        if result["type"] != "success":
            raise RuntimeError(f"{script}: {result['exceptionDetails']['text']}")
        return plain(result["result"])

    def perform(self, source, actions):
        self.call("input.performActions", {"context": self.tab, "actions": [{**source, "actions": actions}]})

    def press_key(self, key, down):
        self.perform({"type": "key", "id": "keys"}, [{"type": "keyDown" if down else "keyUp", "value": KEYS.get(key, key)}])

    def mouse(self, kind, x, y):
        move = {"type": "pointerMove", "x": round(x), "y": round(y)}
        more = {"down": [{"type": "pointerDown", "button": 0}], "up": [{"type": "pointerUp", "button": 0}], "move": []}[kind]
        self.perform({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}}, [move, *more])

    def wheel(self, x, y, by):
        self.perform({"type": "wheel", "id": "wheel"}, [{"type": "scroll", "x": round(x), "y": round(y), "deltaX": 0, "deltaY": by}])

    def put_file(self, element, path):
        node = self.call("script.evaluate", {"expression": f"document.getElementById({element!r})", "target": {"context": self.tab}, "awaitPromise": False})
        self.call("input.setFiles", {"context": self.tab, "element": {"sharedId": node["result"]["sharedId"]}, "files": [path]})

    def picture(self, path, whole=False):
        data = self.call("browsingContext.captureScreenshot", {"context": self.tab, "origin": "document" if whole else "viewport"})
        with open(path, "wb") as file:
            file.write(base64.b64decode(data["data"]))

    def close(self):
        try:
            self.call("browser.close", limit=5)
        except Exception:
            self.process.terminate()
        self.process.wait(timeout=20)
        self.socket.close()
        self.profile.cleanup()


def plain(value):
    """Converts a value from the protocol's form to a Python value."""
    kind = value["type"]
    if kind == "number":
        return float(value["value"].replace("Infinity", "inf")) if isinstance(value["value"], str) else value["value"]
    if kind == "array":
        return [plain(item) for item in value.get("value", [])]
    if kind == "object":
        return {key: plain(item) for key, item in value.get("value", [])}
    return value.get("value")
