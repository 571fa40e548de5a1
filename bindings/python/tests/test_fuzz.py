"""Calls everything in the native module with hostile values. Each call ends in a result or in an exception that the README lists."""

import collections
import json
import math
import random
import subprocess

import numpy
import pytest
import touchstone
from touchstone import _native

CALLS = 100_000
#: What a wrong call raises. A panic in the native code is none of these: it is a ``BaseException`` and ends the test.
DOCUMENTED = (ValueError, TypeError, OverflowError)
NUMBERS = [0.0, -0.0, 5e-324, 1e-300, 1e-9, 2.0**-24, 2.0**-25, 0.1, 127.9999, 128.0, -128.0, 2e9, 2.0**31, 1e300, -1e300, math.inf, -math.inf, math.nan]
WHOLE = [0, 1, -1, 2, 360, 1000, 40_000, 100_000, 100_001, 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**63 - 1, -(2**63), 2**63, 10**40]
OTHERS = [None, True, "", "1e3", "spring", b"1", [], [1.0], (1, 2), {}, 1j, object(), numpy.float32(0.1), numpy.int64(-7), numpy.zeros(2), "\ud800", "ü" * 1000]
GUARD = ["rate_hz", "force_limit_n_m", "count_rad", "damping_n_m_s_per_rad", "share_of_damping", "capacity_j", "refill_w", "overspeed_rad_per_s"]
GUARD += ["delay_s", "lag_s", "change_is_measured"]
SOUND = dict(rate_hz=1000, force_limit_n_m=0.5, count_rad=2e-4, damping_n_m_s_per_rad=4e-4, delay_s=0.0)


def _paths():
    """Paths and words of all settings of the law."""
    try:
        schema = json.loads(subprocess.run([touchstone.program(), "config", "schema", "--json"], check=True, capture_output=True).stdout)
    except touchstone.Failed as missing:
        pytest.skip(str(missing))
    listed = schema if isinstance(schema, list) else schema["settings"]
    return [one["path"] for one in listed if one["path"].startswith(("law.", "wall.", "timing."))]


class Fuzz:
    def __init__(self, seed):
        self.chance = random.Random(seed)
        self.paths = _paths()
        self.guard, self.wall = touchstone.Guard(**SOUND), touchstone.Wall()
        self.limit = 0.5
        self.seen = collections.Counter()

    def number(self):
        """Mostly a small number; else one at an edge, or no number at all."""
        draw = self.chance.random()
        if draw < 0.6:
            return self.chance.gauss(0.0, 0.05)
        if draw < 0.8:
            return self.chance.choice(NUMBERS)
        if draw < 0.95:
            return self.chance.choice(WHOLE)
        return self.chance.choice(OTHERS)

    def array(self):
        values = [self.chance.choice(NUMBERS) if self.chance.random() < 0.02 else self.chance.gauss(0.0, 0.05) for _ in range(self.chance.randrange(12))]
        shape = self.chance.randrange(9)
        array = numpy.array(values)
        if shape == 0:
            return array[::-1]
        if shape == 1:
            return numpy.repeat(array, 2)[::2]
        if shape == 2:
            with numpy.errstate(over="ignore"):
                return array.astype(numpy.float32)
        if shape == 3:
            return array.reshape(1, -1)
        if shape == 4:
            return self.chance.choice([values, self.number(), array.astype(">f8"), array.astype(object)])
        if shape == 5:
            array.flags.writeable = False
        return array

    def arrays(self):
        """Two arrays, more often than not of one length."""
        one, other = self.array(), self.array()
        if self.chance.random() < 0.5:
            return one, one
        return one, other

    def settings(self):
        word = lambda: self.chance.choice(["true", "false", "spring", "tdpa", "measured", "nan", "-1", "1e9", "0x1", "", "٣", "0." + "9" * 400])
        return {
            self.chance.choice(self.paths) if self.chance.random() < 0.9 else self.chance.choice(OTHERS[1:4]): (
                word() if self.chance.random() < 0.3 else self.number()
            )
            for _ in range(self.chance.randrange(4))
        }

    def make_guard(self):
        changed = {name: self.number() for name in GUARD if self.chance.random() < 0.15}
        changed.setdefault("change_is_measured", self.chance.random() < 0.2)
        settings = {**SOUND, **changed}
        if self.chance.random() < 0.05:
            settings.pop(self.chance.choice(list(settings)))
        self.guard = touchstone.Guard(**settings)
        self.limit = float(settings["force_limit_n_m"])

    def make_wall(self):
        words = {}
        if self.chance.random() < 0.4:
            words["counts_per_rev"] = self.number() if self.chance.random() < 0.5 else self.chance.choice(WHOLE)
        if self.chance.random() < 0.3:
            words["surface_rad"] = self.number()
        if self.chance.random() < 0.3:
            words["preset"] = self.chance.choice(["shipped", "thesis", "best", "", None, 3])
        if self.chance.random() < 0.1:
            _native.Wall(self.chance.choice([None, [], [("law.kind", "fba")], [("a",)], [(1, 2)], "ab", [("", "")], {"a": "b"}]), **words)
        self.wall = touchstone.Wall(self.settings(), **words)

    def one(self):
        guard, wall, number, array = self.guard, self.wall, self.number, self.array
        name, call = self.chance.choice(
            [
                ("Guard", self.make_guard),
                ("Guard.tick", lambda: guard.tick(number(), number())),
                ("Guard.tick", lambda: guard.tick(number(), number(), number())),
                ("Guard.ticks", lambda: guard.ticks(*self.arrays())),
                ("Guard.commanded", lambda: guard.commanded(number())),
                ("Guard.switched_off", guard.switched_off),
                ("Guard.resume", guard.resume),
                ("Guard.account_j", lambda: guard.account_j),
                ("Guard.tripped", lambda: guard.tripped),
                ("Wall", self.make_wall),
                ("Wall.tick", lambda: wall.tick(number())),
                ("Wall.tick_count", lambda: wall.tick_count(self.chance.choice(WHOLE + [number()]))),
                ("Wall.ticks", lambda: wall.ticks(array())),
                ("Wall.commanded", lambda: wall.commanded(number())),
                ("Wall.switched_off", wall.switched_off),
                ("Wall.resume", wall.resume),
                ("Wall.account_j", lambda: wall.account_j),
                ("Wall.tripped", lambda: wall.tripped),
                ("Wall.law", lambda: wall.law),
                ("Wall.warnings", lambda: wall.warnings),
            ]
        )
        try:
            result = call()
        except DOCUMENTED as error:
            assert str(error), f"{name}: {type(error).__name__} without words"
            self.seen[name, "refused"] += 1
            return
        self.seen[name, "done"] += 1
        if name.endswith((".tick", ".ticks", ".tick_count")):
            forces = numpy.atleast_1d(result)
            assert numpy.isfinite(forces).all()
            most = self.limit if name.startswith("Guard") else 128.0
            assert numpy.abs(forces).max(initial=0.0) <= most + 2.0**-24, name


def test_no_call_crashes():
    fuzz = Fuzz(seed=50)
    for _ in range(CALLS):
        fuzz.one()
    assert sum(fuzz.seen.values()) == CALLS
    names = {name for name, _ in fuzz.seen}
    native = {f"{kind.__name__}.{name}" for kind in (_native.Guard, _native.Wall) for name in vars(kind) if not name.startswith("_")}
    assert native <= names, f"never called: {native - names}"
    for name in names:
        assert fuzz.seen[name, "done"] > 500, f"{name}: {fuzz.seen[name, 'done']} calls were accepted"
    for name in ("Guard", "Wall", "Guard.tick", "Wall.tick", "Guard.ticks", "Wall.ticks", "Guard.commanded", "Wall.commanded", "Wall.tick_count"):
        assert fuzz.seen[name, "refused"] > 100, f"{name}: {fuzz.seen[name, 'refused']} calls were refused"
