"""Prints how many control periods (ticks) per second one core computes from Python: ``python -m touchstone.speed``."""

from __future__ import annotations

import time
from typing import Any, Callable, Iterator

import numpy

from ._native import Guard
from ._wall import Wall

#: Walls from the least computing time to the shipped one. The first has neither estimator nor guard.
WALLS: dict[str, dict[str, Any]] = {
    "spring alone": {"law.kind": "spring", "law.states": "measured", "law.guard.on": False},
    "damped spring with guard": {"law.kind": "spring-damper", "law.states": "measured"},
    "shipped wall with estimator and guard": {},
}


def _guard() -> Guard:
    return Guard(rate_hz=1000, force_limit_n_m=0.5, count_rad=1.6e-4, damping_n_m_s_per_rad=4e-4, delay_s=0.0)


def _rate(ticks: int, work: Callable[[], object]) -> float:
    """Ticks per second; the best of five, because other programs can only make it slower."""
    best = float("inf")
    for _ in range(5):
        begun = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begun)
    return ticks / best


def speeds(ticks: int = 200_000) -> Iterator[tuple[str, float, float]]:
    """For each wall and for the guard: its name, ticks per second in one call for all, and with one call for each tick."""
    # A press into the wall and out again, ten times a second.
    places = 0.005 * numpy.sin(numpy.arange(ticks) * (2 * numpy.pi / 100))
    singly = places.tolist()
    for name, settings in WALLS.items():
        wall = Wall(settings)

        def one_by_one(tick: Callable[[float], float] = wall.tick) -> None:
            for place in singly:
                tick(place)

        yield name, _rate(ticks, lambda: wall.ticks(places)), _rate(ticks, one_by_one)
    guard = _guard()
    moved, wanted = numpy.diff(places, prepend=0.0), 40.0 * places
    pairs = list(zip(moved.tolist(), wanted.tolist()))

    def guarded() -> None:
        for step, force in pairs:
            guard.tick(step, force)

    yield "guard alone", _rate(ticks, lambda: guard.ticks(moved, wanted)), _rate(ticks, guarded)


if __name__ == "__main__":
    print("million ticks per second on one core:")
    print(f"{'':<40}{'one call for all':>18}{'one call for each':>19}")
    for name, batch, single in speeds(1_000_000):
        print(f"{name:<40}{batch / 1e6:>18.2f}{single / 1e6:>19.2f}")
