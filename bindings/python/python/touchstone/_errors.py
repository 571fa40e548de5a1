"""The errors of the program ``touchstone`` as Python exceptions."""

from __future__ import annotations

from typing import Any


class Failed(RuntimeError):
    """Error: the program ``touchstone`` ended without a result. ``code`` is its exit code."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code

    def __reduce__(self) -> Any:
        # Exceptions come back from worker processes by pickle, which calls the class with `args`: the message alone.
        return type(self), (str(self), self.code)


class Mistake(Failed, ValueError):
    """Error: an option, a scene or a file of the call is wrong. The message names place, problem and remedy."""


class NotMet(Failed):
    """Error: the simulation ended, but a requirement on its result (such as ``expect=``) does not hold. ``results`` has the results."""

    def __init__(self, message: str, code: int, results: dict[str, Any]) -> None:
        super().__init__(message, code)
        self.results = results

    def __reduce__(self) -> Any:
        return type(self), (str(self), self.code, self.results)


class MayBeOn(Failed):
    """Error: a board did not confirm that its motor is off. Switch its power off, or pull its plug."""
