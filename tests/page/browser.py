"""The part of browser control that is the same for every browser; chromium.py and firefox.py have the protocols. Standard library only."""

import shutil
import tempfile
import time


def found(*names):
    """Path of the first of these programs that is installed, or None."""
    return next((path for name in names if name and (path := shutil.which(name))), None)


class Page:
    """One page in a browser without a window. `problems` keeps the errors and warnings of the page.

    A subclass has `message`, `note`, `call`, `run` and the methods that differ between the protocols.
    """

    def __init__(self):
        self.profile = tempfile.TemporaryDirectory()
        self.problems, self.number = [], 0
        # A function that is called some fifty times a second while the test waits, e.g. to carry the bytes of a simulated cable.
        self.meanwhile = None

    def wait(self, seconds):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if self.meanwhile:
                self.meanwhile()
                left = min(left, 0.02)
            if (message := self.message(left)) is not None:
                self.note(message)

    def comes_true(self, script, limit=20):
        """Waits until a JavaScript expression is true. Returns whether it came true within `limit` seconds."""
        end = time.monotonic() + limit
        while not self.run(script):
            if time.monotonic() > end:
                return False
            self.wait(0.05)
        return True

    def until(self, script, limit=20):
        """Waits until a JavaScript expression is true; an error if it is not within `limit` seconds."""
        if not self.comes_true(script, limit):
            raise TimeoutError(f"never came true: {script}; {self.problems}")

    def key(self, key, hold=0.02):
        self.press_key(key, True)
        self.wait(hold)
        self.press_key(key, False)
