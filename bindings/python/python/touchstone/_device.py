"""A haptic device with the guard between it and whatever wants a force: a teleoperator's follower, a simulator, a network."""

from __future__ import annotations

import math
from typing import Any, Callable

from ._native import Guard


class GuardedDevice:
    """Plays forces on a device through the guard, and none that is too old.

    ``read()`` gives the device's position, rad (m); ``write(force)`` commands its motor along the position, N·m (N). ``guard`` takes the keywords of
    ``Guard``. Call ``step`` once every ``1 / rate_hz``, from one thread; a force from elsewhere (another thread, a network) comes with its
    age, and beyond ``stale_after_s`` counts as none.

        >>> device = GuardedDevice(read, write, rate_hz=1000, force_limit_n_m=0.5, count_rad=2e-4, damping_n_m_s_per_rad=4e-4)
        >>> device.step(wanted=-0.2, age_s=0.003)

    At most ``capacity_j + refill_w * time`` reaches the hand beyond what it put in, under the conditions of ``Guard``.
    """

    def __init__(
        self, read: Callable[[], float], write: Callable[[float], object], *, stale_after_s: float = 0.05, **guard: Any
    ) -> None:
        if not stale_after_s >= 0:
            raise ValueError(f"stale_after_s = {stale_after_s}: give a time of at least 0 s")
        self.guard = Guard(**guard)
        self.force_limit = guard["force_limit_n_m"]
        self.stale_after_s = stale_after_s
        self.stale_steps = 0
        self._read, self._write = read, write
        self._last: float | None = None

    def step(self, wanted: float, age_s: float = 0.0) -> float:
        """One control period: reads, bounds, writes; the force that was written, along the position.

        After overspeed it writes 0 until ``resume``. Where reading or writing fails, the motor is written 0, the account is empty, and the
        error goes on.
        """
        try:
            position = self._read()
            if not age_s <= self.stale_after_s:
                wanted, self.stale_steps = 0.0, self.stale_steps + 1
            # `min` and `max` would make a limit of it.
            if math.isnan(wanted):
                raise ValueError("wanted is not a number")
            wanted = max(-self.force_limit, min(self.force_limit, wanted))
            moved = 0.0 if self._last is None else position - self._last
            # The guard counts a force that resists a motion as positive.
            force = -self.guard.tick(moved, -wanted)
            self._last = position
            self._write(force)
            return force
        except BaseException:
            self._end()
            raise

    def off(self) -> None:
        """Switches the force off, after a last step that accounts for it. ``resume`` before the next ``step``."""
        self.step(0.0)
        self._end()

    def _end(self) -> None:
        """Switches the force off at once. Nobody knows how long the last one acted, so the guard empties the account for it."""
        try:
            self._write(0.0)
        finally:
            self.guard.switched_off()
            self._last = None

    def resume(self) -> None:
        """Goes on after ``off`` or overspeed, with the account that there was."""
        self.guard.resume()
        self._last = None

    def __enter__(self) -> GuardedDevice:
        return self

    def __exit__(self, *_: object) -> None:
        self.off()
