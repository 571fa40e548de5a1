"""What the pages' scripts ask of any browser; how it is spoken to is in chromium.py and firefox.py. Standard library only."""

import shutil
import tempfile
import time


def found(*names):
    """Path of the first of these programs that is here, or None."""
    return next((path for name in names if name and (path := shutil.which(name))), None)


class Page:
    """One page of one browser without a window; what goes wrong in it is kept in `problems`.

    A subclass has `message`, `note`, `call`, `run` and what its protocol says differently.
    """

    def __init__(self):
        self.profile = tempfile.TemporaryDirectory()
        self.problems, self.number = [], 0
        # Called some fifty times a second while the script waits: for what stands between page and world.
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
        """Waits until the expression is true; whether it came true in time."""
        end = time.monotonic() + limit
        while not self.run(script):
            if time.monotonic() > end:
                return False
            self.wait(0.05)
        return True

    def until(self, script, limit=20):
        """Waits until the expression is true."""
        if not self.comes_true(script, limit):
            raise TimeoutError(f"never came true: {script}; {self.problems}")

    def key(self, key, hold=0.02):
        self.press_key(key, True)
        self.wait(hold)
        self.press_key(key, False)
