"""A haptic device with the energy guard between its motor and a source of forces: a teleoperator's follower, a simulator or a network."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, Callable, Protocol, overload

from ._native import Guard


@dataclasses.dataclass(frozen=True)
class Device:
    """The properties of a haptic device from which the settings of guard and wall follow.

    Units are rad and N·m; with m and N the same numbers serve a linear device, and ``counts_per_rev`` counts one encoder count each ``2 pi /
    counts_per_rev`` m. ``damping_n_m_s_per_rad`` is that of the device without a hand, as measured: the guard counts on 0.8 of it.
    """

    #: Control rate, Hz.
    rate_hz: int
    #: Inertia of the part that moves. The guard does not use it.
    inertia_kg_m2: float
    #: Damping without a hand, as measured; a value that is too small is safe.
    damping_n_m_s_per_rad: float
    #: Encoder counts in one revolution; too few are safe.
    counts_per_rev: int
    #: Largest torque of the motor; a value that is too small is safe.
    force_limit_n_m: float
    #: Time from reading the position until the new torque begins to act, s. It must be right: no error is safe.
    delay_s: float
    #: Time constant with which the torque then rises, s. It must be right too.
    lag_s: float = 0.0

    def __post_init__(self) -> None:
        # The guard checks the other properties.
        for name in ("inertia_kg_m2", "counts_per_rev"):
            value = getattr(self, name)
            if not 0 < value < math.inf:
                raise ValueError(f"{name} = {value}: give a number above 0")

    @property
    def count_rad(self) -> float:
        """Angle of one encoder count."""
        return 2 * math.pi / self.counts_per_rev

    def guard_settings(self, **more: Any) -> dict[str, Any]:
        """The keywords of ``Guard`` for this device. ``more`` adds others, such as ``capacity_j``."""
        return {
            "rate_hz": self.rate_hz,
            "force_limit_n_m": self.force_limit_n_m,
            "count_rad": self.count_rad,
            "damping_n_m_s_per_rad": self.damping_n_m_s_per_rad,
            "delay_s": self.delay_s,
            "lag_s": self.lag_s,
            **more,
        }

    def kinetic_energy_j(self, speed_rad_per_s: float) -> float:
        """Energy of the moving device, J. A hand may get it out beside what the guard allows."""
        return 0.5 * self.inertia_kg_m2 * speed_rad_per_s**2


class Readable(Protocol):
    """A device that gives its position and takes a force."""

    def read(self) -> float:
        """The position, rad (m)."""

    def write(self, force: float, /) -> object:
        """Commands the motor's force along the position, N·m (N)."""


class GuardedDevice:
    """Commands requested forces on a haptic device through the energy guard; a force that is too old counts as 0.

    ``device.read()`` gives the position, rad (m); ``device.write(force)`` commands the motor along the position, N·m (N). ``Device`` has the device's
    properties. Call ``step`` once every ``1 / rate_hz`` seconds, from one thread. Give the age of a force that comes from another thread or a
    network; a force older than ``stale_after_s`` counts as 0. ``guard`` takes further keywords of ``Guard``.

        >>> knob = Device(rate_hz=1000, inertia_kg_m2=1e-4, damping_n_m_s_per_rad=4e-4, counts_per_rev=16384, force_limit_n_m=0.5, delay_s=1e-4)
        >>> guarded = GuardedDevice(device, knob)
        >>> guarded.step(wanted=-0.2, age_s=0.003)

    Two functions and all keywords of ``Guard`` serve instead: ``GuardedDevice(read, write, rate_hz=1000, …)``.

    Beyond what it put in and the device's kinetic energy, the hand gets at most ``capacity_j + refill_w * time`` and half a count times the
    largest force, under the conditions of ``Guard``.
    """

    @overload
    def __init__(self, read: Readable, write: Device, *, stale_after_s: float = 0.05, **guard: Any) -> None: ...
    @overload
    def __init__(self, read: Callable[[], float], write: Callable[[float], object], *, stale_after_s: float = 0.05, **guard: Any) -> None: ...
    def __init__(self, read: Any, write: Any, *, stale_after_s: float = 0.05, **guard: Any) -> None:
        if isinstance(write, Device):
            guard = write.guard_settings(**guard)
            read, write = read.read, read.write
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
            # Checked here, because `min` and `max` would turn NaN into the force limit.
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
