"""The program `touchstone`: the simulator, its verdicts and its measures, as functions."""

import json
import os
import shutil
import subprocess
import sysconfig
import tempfile
from pathlib import Path

from ._text import text


class Failed(RuntimeError):
    """The program ended without a result. ``code`` is its exit code."""

    def __init__(self, message, code):
        super().__init__(message)
        self.code = code


class Mistake(Failed, ValueError):
    """A mistake in what was asked: option, scene, file. The message names place, problem and remedy."""


class NotMet(Failed):
    """The run is done, but a demand on it does not hold. ``results`` has what came."""

    def __init__(self, message, code, results):
        super().__init__(message, code)
        self.results = results


def program():
    """The path of the program: ``TOUCHSTONE_PROGRAM``, that of this package, or one on the PATH."""
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


def _ask(*words):
    """What the program prints as JSON."""
    done = subprocess.run([program(), *words, "--json"], capture_output=True, stdin=subprocess.DEVNULL, encoding="utf-8", check=False)
    said = done.stderr.strip()
    if done.returncode in (0, 3) and done.stdout:
        results = json.loads(done.stdout)
        if done.returncode == 3:
            raise NotMet(said, 3, results)
        return results
    kind = Mistake if done.returncode == 2 else Failed
    raise kind(said or f"exit code {done.returncode}", done.returncode)


def _options(options):
    """Keywords as options: ``k_desired=5`` is ``--k-desired 5``, ``quick=True`` is ``--quick``."""
    words = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is True:
            words.append(option)
        elif value is not None and value is not False:
            values = value if isinstance(value, (list, tuple)) else [value]
            for one in values:
                words += [option, os.fspath(one) if isinstance(one, os.PathLike) else text(one)]
    return words


def _changes(changes):
    words = []
    for path, value in (changes or {}).items():
        words += ["--set", f"{path}={text(value)}"]
    return words


def _toml(table, prefix=""):
    """A scene's dict as TOML: tables of tables, texts, numbers, lists."""
    lines, tables = [], []
    for key, value in table.items():
        if isinstance(value, dict):
            tables.append((key, value))
        else:
            lines.append(f"{key} = {json.dumps(value, default=float)}")
    for key, value in tables:
        name = f"{prefix}{key}"
        lines += [f"[{name}]", _toml(value, name + ".")]
    return "\n".join(lines)


class _Scene:
    """A scene as the program takes it: a shipped name, a file, or a dict written to one."""

    def __init__(self, scene):
        self.file = None
        if isinstance(scene, dict):
            handle, self.file = tempfile.mkstemp(suffix=".toml", prefix="touchstone-")
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                file.write(_toml(scene))
        self.name = self.file or os.fspath(scene)

    def __enter__(self):
        return self.name

    def __exit__(self, *_):
        if self.file:
            os.unlink(self.file)


class Run(dict):
    """The results of ``run``: a dict as ``results.json`` has it, with its measures and traces at hand."""

    #: Where traces were written; ``None`` without ``trace=True``.
    folder = None

    @property
    def summary(self):
        """The measures of the run, by name; ``results["units"]`` has their units."""
        return self["runs"][0]

    @property
    def verdict(self):
        """passive, active, limit-cycle, unstable or no-contact."""
        return self.summary["verdict"]

    def trace(self):
        """Every tick as a dict of numpy arrays, by column (with its unit in its name)."""
        import numpy

        if self._columns is None:
            raise Failed("no trace was kept: run with trace=True", 2)
        names, values = self._columns
        return {name: numpy.ascontiguousarray(values[:, index]) for index, name in enumerate(names)}

    _columns = None


def run(scene="thesis-knob", changes=None, *, trace=False, **options):
    """Runs a scene: a shipped name, a path, or a dict. ``changes`` maps fields to values; other keywords are the program's options.

    ``run("tap", {"device.inertia_kg_m2": 2e-4}, expect="passive", trace=True)``. Raises ``Mistake`` with place, problem and remedy, and
    ``NotMet`` where a demand (``expect=``, ``max_penetration=`` …) does not hold.
    """
    with _Scene(scene) as name, tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
        words = ["run", name, *_changes(changes), *_options(options)]
        if trace:
            words += ["--out", str(Path(folder) / "run")]
        done = Run(_ask(*words))
        if trace:
            import numpy

            file = next((Path(folder) / "run" / "traces").glob("*.csv"))
            with open(file, encoding="utf-8") as rows:
                names = rows.readline().strip().split(",")
                done._columns = names, numpy.loadtxt(rows, delimiter=",", ndmin=2)
        return done


def scorecard(scene="thesis-knob", changes=None, **options):
    """Compares laws by what a hand feels: ``scorecard("thesis-knob", law=["enhanced", "spring"], k_desired=14)``."""
    with _Scene(scene) as name:
        return _ask("scorecard", name, *_changes(changes), *_options(options))


def tune(device="thesis-knob", changes=None, **options):
    """Finds settings for a device: ``tune("DEVICE.toml", quick=True, out="tuned.toml")``."""
    with _Scene(device) as name:
        return _ask("tune", name, *_changes(changes), *_options(options))


def certify(scene="thesis-knob", changes=None, **options):
    """Says whether a wall is stable, for which hands, and by which margins, without a run."""
    with _Scene(scene) as name:
        return _ask("certify", name, *_changes(changes), *_options(options))


def scenes():
    """The scenes that come with the program."""
    return _ask("scenes")
