"""Python functions that run the program ``touchstone`` (simulator of haptic devices) and return its results."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sysconfig
import tempfile
from pathlib import Path
from typing import Any, Mapping, Union

import numpy

from . import _frames
from ._errors import Failed, Mistake, NotMet
from ._text import number, text

#: A scene (description of a simulation): the name of a shipped scene, the path of a TOML file, or a dict.
Scene = Union[str, "os.PathLike[str]", Mapping[str, Any]]
#: Changes of a scene: paths of its fields, such as "device.inertia_kg_m2", and their new values.
Changes = Union[Mapping[str, Any], None]


def program() -> str:
    """The path of the program ``touchstone``. Looks in the variable ``TOUCHSTONE_PROGRAM``, in this package and on the PATH, in this order."""
    given = os.environ.get("TOUCHSTONE_PROGRAM")
    if given:
        return given
    name = "touchstone.exe" if os.name == "nt" else "touchstone"
    for scheme in (sysconfig.get_default_scheme(), f"{os.name}_user"):
        beside = Path(sysconfig.get_path("scripts", scheme)) / name
        if beside.is_file():
            return str(beside)
    found = shutil.which(name)
    if found is None:
        raise Failed(f"{name}: no such program; install the wheel, or name one in TOUCHSTONE_PROGRAM", 1)
    return found


def _ask(*words: str) -> dict[str, Any]:
    """Runs the program ``touchstone`` with these arguments; returns the JSON that it prints."""
    done = subprocess.run([program(), *words, "--json"], capture_output=True, stdin=subprocess.DEVNULL, encoding="utf-8", check=False)
    said = done.stderr.strip()
    if done.returncode in (0, 3) and done.stdout:
        results: dict[str, Any] = json.loads(done.stdout)
        if done.returncode == 3:
            raise NotMet(said, 3, results)
        return results
    kind = Mistake if done.returncode == 2 else Failed
    raise kind(said or f"exit code {done.returncode}", done.returncode)


def _options(options: Mapping[str, Any]) -> list[str]:
    """Converts keywords to options of the program: ``k_desired=5`` to ``--k-desired 5``, ``quick=True`` to ``--quick``."""
    words: list[str] = []
    for name, given in options.items():
        option = "--" + name.replace("_", "-")
        value = given if isinstance(given, (list, tuple)) else number(given)
        if value is True:
            words.append(option)
        elif value is not None and value is not False:
            values = value if isinstance(value, (list, tuple)) else [value]
            for one in values:
                words += [option, os.fspath(one) if isinstance(one, os.PathLike) else text(one)]
    return words


def _changes(changes: Changes) -> list[str]:
    words: list[str] = []
    for path, value in (changes or {}).items():
        words += ["--set", f"{path}={text(value)}"]
    return words


def _plain(value: Any) -> Any:
    """Converts a value that JSON does not know: a number of numpy, or one that is only a float, such as a ``Fraction``."""
    plain: Any = number(value)
    return float(value) if plain is value else plain


def _toml(table: Mapping[str, Any], prefix: str = "") -> str:
    """Converts a scene's dict to TOML text. The dict may hold tables, texts, numbers and lists."""
    lines, tables = [], []
    for key, value in table.items():
        if isinstance(value, dict):
            tables.append((key, value))
        else:
            lines.append(f"{key} = {json.dumps(value, default=_plain)}")
    for key, value in tables:
        name = f"{prefix}{key}"
        lines += [f"[{name}]", _toml(value, name + ".")]
    return "\n".join(lines)


class _Scene:
    """A scene as an argument of the program: the name of a shipped scene or a file's path. A dict is written to a temporary file."""

    def __init__(self, scene: Scene) -> None:
        self.file: str | None = None
        if isinstance(scene, Mapping):
            handle, self.file = tempfile.mkstemp(suffix=".toml", prefix="touchstone-")
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                file.write(_toml(scene))
            self.name = self.file
        else:
            self.name = os.fspath(scene)

    def __enter__(self) -> str:
        return self.name

    def __exit__(self, *_: object) -> None:
        if self.file:
            os.unlink(self.file)


class Run(dict[str, Any]):
    """The results of ``run``: a dict with the content of the program's ``results.json``. ``summary``, ``verdict`` and ``trace`` give parts of it."""

    _columns: tuple[list[str], numpy.ndarray] | None = None

    @property
    def summary(self) -> dict[str, Any]:
        """The measured values of the simulation, by name; the dict's entry ``units`` has their units."""
        summary: dict[str, Any] = self["runs"][0]
        return summary

    @property
    def verdict(self) -> str:
        """The program's verdict on the simulated wall: passive, active, limit-cycle, unstable, not-judged or no-contact."""
        return str(self.summary["verdict"])

    def trace(self) -> dict[str, numpy.ndarray]:
        """The values of every control period: a dict of numpy arrays by column name. A name such as ``angle_rad`` contains the unit."""
        if self._columns is None:
            raise Failed("no trace was kept: run with trace=True", 2)
        names, values = self._columns
        return {name: numpy.ascontiguousarray(values[:, index]) for index, name in enumerate(names)}

    def frame(self) -> Any:
        """The measured values as a pandas dataframe with one row. Names of columns end with the unit: ``k_displayed_n_m_per_rad``."""
        # Results of three axes have no table of units: their names contain them already.
        return _frames.of_runs(self["runs"], self.get("units", {}))

    def trace_frame(self) -> Any:
        """The values of every control period as a pandas dataframe, with the columns of ``trace``."""
        return _frames.pandas().DataFrame(self.trace())


def run(scene: Scene = "thesis-knob", changes: Changes = None, *, trace: bool = False, **options: Any) -> Run:
    """Simulates a scene: the name of a shipped scene, a path, or a dict. ``changes`` maps fields to values; other keywords are the program's options.

    ``trace=True`` keeps the values of every control period; only scenes of one axis have them.
    ``run("tap", {"device.inertia_kg_m2": 2e-4}, expect="passive", trace=True)``. Raises ``Mistake`` with place, problem and remedy, and
    ``NotMet`` if a requirement (``expect=``, ``max_penetration=`` …) does not hold.
    """
    with _Scene(scene) as name, tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
        words = ["run", name, *_changes(changes), *_options(options)]
        if trace:
            words += ["--out", str(Path(folder) / "run")]
        done = Run(_ask(*words))
        if trace:
            file = next((Path(folder) / "run" / "traces").glob("*.csv"), None)
            if file is None:
                raise Mistake("a scene of three axes keeps no trace of every tick; run it without trace=True", 2)
            with open(file, encoding="utf-8") as rows:
                names = rows.readline().strip().split(",")
                done._columns = names, numpy.loadtxt(rows, delimiter=",", ndmin=2)
        return done


def scorecard(scene: Scene = "thesis-knob", changes: Changes = None, **options: Any) -> dict[str, Any]:
    """Compares control laws by the wall that a hand feels: ``scorecard("thesis-knob", law=["enhanced", "spring"], k_desired=14)``."""
    with _Scene(scene) as name:
        return _ask("scorecard", name, *_changes(changes), *_options(options))


def tune(device: Scene = "thesis-knob", changes: Changes = None, **options: Any) -> dict[str, Any]:
    """Searches for the best settings of control law and guard for a device: ``tune("DEVICE.toml", quick=True, out="tuned.toml")``."""
    with _Scene(device) as name:
        return _ask("tune", name, *_changes(changes), *_options(options))


def certify(scene: Scene = "thesis-knob", changes: Changes = None, **options: Any) -> dict[str, Any]:
    """Calculates, without a simulation, whether a virtual wall is stable, for which hands, and with which margins."""
    with _Scene(scene) as name:
        return _ask("certify", name, *_changes(changes), *_options(options))


def scenes() -> dict[str, Any]:
    """The scenes that are shipped with the program."""
    return _ask("scenes")
