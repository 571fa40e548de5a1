"""A haptic device with the energy guard between its motor and a source of forces: a teleoperator's follower, a simulator or a network."""

from __future__ import annotations

import math
from typing import Any, Callable

from ._native import Guard


class GuardedDevice:
    """Commands requested forces on a haptic device through the energy guard; a force that is too old counts as 0.

    ``read()`` gives the device's position, rad (m); ``write(force)`` commands its motor along the position, N·m (N). ``guard`` takes the keywords of
    ``Guard``. Call ``step`` once every ``1 / rate_hz`` seconds, from one thread. Give the age of a force that comes from another thread or a
    network; a force older than ``stale_after_s`` counts as 0.

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
        """Runs one control period: reads the position, bounds the force ``wanted`` and writes it. Returns the written force along the position, N·m (N).

        After an over-speed it writes 0 until ``resume``. If reading or writing fails, it writes 0 to the motor, empties the energy account
        and raises the error again.
        """
        try:
            position = self._read()
            if not age_s <= self.stale_after_s:
                wanted, self.stale_steps = 0.0, self.stale_steps + 1
            # Checked here, because `min` and `max` would turn it into the force limit.
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
        """Runs a last step, which counts the energy of the last force, and switches the force off. Call ``resume`` before the next ``step``."""
        self.step(0.0)
        self._end()

    def _end(self) -> None:
        """Switches the force off at once. The guard then empties its energy account, because it does not know how long the last force acted."""
        try:
            self._write(0.0)
        finally:
            self.guard.switched_off()
            self._last = None

    def resume(self) -> None:
        """Lets forces act again after ``off`` or an over-speed; the guard's energy account keeps its level."""
        self.guard.resume()
        self._last = None

    def __enter__(self) -> GuardedDevice:
        return self

    def __exit__(self, *_: object) -> None:
        self.off()
