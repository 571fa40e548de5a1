"""A board with Touchstone's firmware, or the simulated knob of ``touchstone demo``: settings, switching on and off, measurements."""

from __future__ import annotations

import csv
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any, Iterator

from ._errors import Failed, MayBeOn
from ._program import _ask, program
from ._text import text

#: States in which the motor may move the shaft.
ON = ("armed", "calibrating")
#: Columns of a record that are texts, and columns that are whole numbers; all others are decimal numbers.
WORDS = ("state", "fault", "limits")
COUNTS = ("tick", "count", "cycles", "lateness_cycles")
#: Time between two looks for new records, s.
LOOK_S = 0.02


class Board:
    """A board at a serial port, or a simulated one at a TCP port. Every call connects, asks and disconnects.

    ``port`` is ``"/dev/ttyACM0"``, ``"COM3"`` or ``"tcp:HOST:PORT"``; without it, the only board at this computer. ``with`` switches the motor off at
    its end, whatever happened, and raises ``MayBeOn`` if the board does not confirm that.

        >>> with Board("/dev/ttyACM0") as board:
        ...     board.set("wall.k_desired_n_m_per_rad", 5)
        ...     board.calibrate()  # THE SHAFT MOVES
        ...     board.arm()
        ...     for record in board.monitor(seconds=10):
        ...         print(record["time_s"], record["force_n_m"])

    An armed board switches off if this computer is silent for ``limits.host_silence_s``: let ``monitor`` run while the board is armed.
    """

    def __init__(self, port: str | None = None) -> None:
        self.port = port
        self._monitors: list[subprocess.Popen[bytes]] = []

    def _ask(self, *words: str) -> dict[str, Any]:
        return _ask(*words, *self._place())

    def _place(self) -> list[str]:
        return ["--port", self.port] if self.port else []

    def info(self) -> dict[str, Any]:
        """Identity, state, fault and counters of the board, as ``touchstone device status --json``."""
        return self._ask("device", "status")

    @property
    def state(self) -> str:
        """State of the board: boot, calibrating, ready, armed, fault or stopped."""
        return str(self.info()["state"])

    def settings(self, *paths: str) -> dict[str, Any]:
        """The settings by path: those named, those below a table such as ``"wall"``, or all. Their names end with the unit."""
        return {one["path"]: one["value"] for one in self._ask("config", "get", *paths)["settings"]}

    def get(self, path: str) -> Any:
        """The value of one setting."""
        return self.settings(path)[path]

    def set(self, path: str, value: Any) -> None:
        """Changes one setting, which takes effect from the next calibration on. ``save`` keeps it over a restart."""
        self._ask("config", "set", path, text(value))

    def save(self) -> None:
        """Saves the settings in the board's flash."""
        self._ask("config", "save")

    def calibrate(self) -> None:
        """Measures direction, pole pairs and electrical offset, and waits for the end. THE SHAFT MOVES."""
        self._ask("device", "calibrate")

    def arm(self) -> None:
        """Switches the motor on: from now on the wall acts."""
        self._ask("device", "arm")

    def disarm(self) -> None:
        """Switches the motor off and checks that the board says so. Raises ``MayBeOn`` if it does not. A board that is off stays as it is."""
        try:
            state = self.state
            if state in ON:
                # A calibration cannot be disarmed, only stopped.
                self._ask("device", "disarm" if state == "armed" else "stop")
                state = self.state
        except Failed as failed:
            state = self._stopped(str(failed))
        if state in ON:
            self._stopped(f"its state is {state}")

    def _stopped(self, why: str) -> str:
        """Stops the board after ``disarm`` failed; returns its state."""
        try:
            self.stop()
            state = self.state
        except Failed as failed:
            raise MayBeOn(f"THE BOARD MAY STILL BE ON: {why}; switch its power off, or pull its plug", failed.code) from failed
        if state in ON:
            raise MayBeOn(f"THE BOARD MAY STILL BE ON: its state is {state}; switch its power off, or pull its plug", 1)
        return state

    def stop(self) -> None:
        """Switches the motor off, discards the calibration and clears a fault."""
        self._ask("device", "stop")

    def monitor(self, seconds: float | None = None, decimation: int = 1) -> Iterator[dict[str, Any]]:
        """Yields the records that the board sends: a dict for every ``decimation``-th control period. Units are at the end of the names.

        Ends after ``seconds``, or when the loop is left. Records arrive 128 at a time. A gap in ``tick`` shows that records were lost. No other call
        of this board may run meanwhile: a port has one user.
        """
        with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
            # A file, because a full pipe would block the program if the caller's loop is slow. A blocked program sends no
            # requests, and the board would switch off.
            file, said = Path(folder) / "records.csv", Path(folder) / "errors.txt"
            words = ["monitor", *self._place(), "--csv", str(file), "--decimation", str(decimation)]
            if seconds is not None:
                words += ["--seconds", text(seconds)]
            with open(said, "wb") as errors:
                process = subprocess.Popen([program(), "--quiet", *words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors)
            self._monitors.append(process)
            try:
                yield from _records(process, file)
            finally:
                left = process.poll() is None
                self._end(process)
            if not left and process.returncode != 0:
                raise Failed(said.read_text(encoding="utf-8").strip(), process.returncode)

    def _end(self, process: subprocess.Popen[bytes]) -> None:
        if process in self._monitors:
            self._monitors.remove(process)
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        for process in list(self._monitors):
            self._end(process)
        self.disarm()


def _records(process: subprocess.Popen[bytes], file: Path) -> Iterator[dict[str, Any]]:
    """Reads the records that a running monitor appends to its file, until the monitor has ended."""
    while not file.exists() and process.poll() is None:
        time.sleep(LOOK_S)
    if not file.exists():
        return
    with open(file, encoding="utf-8", newline="") as rows:
        names: list[str] = []
        begun = ""
        while True:
            # Checked before reading, so that the last rows of a monitor that has ended are read, too.
            ended = process.poll() is not None
            begun += rows.read()
            *lines, begun = begun.split("\n")
            for row in csv.reader(lines):
                if names:
                    yield {name: _value(name, value) for name, value in zip(names, row)}
                else:
                    names = row
            if ended:
                return
            if not lines:
                time.sleep(LOOK_S)


def _value(name: str, value: str) -> Any:
    return value if name in WORDS else int(value) if name in COUNTS else float(value)
