"""A haptic device with three axes whose wall and energy guard run in a thread of their own, beside Python."""

from __future__ import annotations

import os
import weakref
from typing import Any, Sequence

import numpy
import numpy.typing

from . import _native
from ._errors import Failed, MayBeOn, Mistake

Array = numpy.typing.NDArray[numpy.float64]


class HapticDevice:
    """An omega.3, an Inverse3 or a simulated omega.3, with a wall and the energy guard at ``rate_hz`` in a thread that never waits for Python.

    **THE MOTORS ARE ON from here until** ``close``, the end of ``with``, or the end of Python. A killed process cannot switch them off; only the
    device's own watchdog can.

    ``device`` is ``"omega3"``, ``"inverse3"`` (whose service sets the rate) or ``"simulated"``. ``wall`` is ``None``, ``"plane"`` (a floor through
    the workspace's centre), ``"inclined"`` or ``"sphere"`` (radius 30 mm). Without ``stiffness_n_per_mm``, the wall is the tuned one, where the device and
    rate have one, else 5 N/mm with the thesis' settings, or 1 N/mm for an Inverse3. Forces fade in over the first second.

    ``send_force`` adds the force of a distant follower. Wall and follower together go through the guard: the hand gets at most 40 mJ and 0.5 mW
    beyond what it put in, if device and delay are as assumed (``docs/devices.md``). A follower's force acts for ``stale_after_s`` and then fades to 0
    in ``fade_s``, unless a newer one comes.

    ``library`` is Force Dimension's library, ``service`` the ``HOST:PORT`` of Haply's service. ``late_limit_s`` is the lateness that ends the
    loop. ``priority`` requests real-time priority for the thread. ``hand_m`` is where a simulated hand holds the simulated device; ``None`` for no
    hand.

    The loop ends by itself on a fault: ``fault`` says why, the motors are off, and ``send_force`` raises it as ``Failed``. Raises ``Mistake`` for a
    wrong argument, and ``Failed`` if the device cannot be used.

        >>> with HapticDevice("simulated", wall="plane") as device:
        ...     device.send_force([0.0, 0.0, 1.0])  # N on the hand
        ...     device.position_m  # m: array of x, y and z
    """

    def __init__(
        self,
        device: str = "omega3",
        *,
        wall: str | None = None,
        rate_hz: int = 1000,
        stiffness_n_per_mm: float | None = None,
        force_limit_n: float | None = None,
        stale_after_s: float = 0.05,
        fade_s: float = 0.05,
        late_limit_s: float = 0.01,
        library: str | os.PathLike[str] | None = None,
        service: str | None = None,
        hand_m: Sequence[float] | None = (0.0, 0.0, 0.01),
        priority: bool = True,
    ) -> None:
        try:
            inner = _native.HapticDevice(
                device,
                wall=wall,
                rate_hz=rate_hz,
                stiffness_n_per_mm=stiffness_n_per_mm,
                force_limit_n=force_limit_n,
                stale_after_s=stale_after_s,
                fade_s=fade_s,
                late_limit_s=late_limit_s,
                library=None if library is None else os.fspath(library),
                service=service,
                hand_m=None if hand_m is None else _three(hand_m),
                priority=priority,
            )
        except ValueError as wrong:
            raise Mistake(str(wrong), 2) from None
        except RuntimeError as why:
            raise Failed(str(why), 1) from None
        self._inner = inner
        # Closes the device also when Python ends. Otherwise Python would stop the thread while a force acts.
        self._end = weakref.finalize(self, inner.close)

    def send_force(self, force_n: Sequence[float] | Array, age_s: float = 0.0) -> None:
        """Replaces the follower's force on the hand, N, that was measured ``age_s`` ago. Three numbers: x, y and z."""
        self._inner.send_force(_three(force_n), age_s)
        self.check()

    def check(self) -> None:
        """Raises ``Failed`` with the reason if the loop has ended."""
        if not self._inner.is_running:
            raise Failed(self._inner.fault or f"{self.name}: it is closed; open it again", 1)

    @property
    def position_m(self) -> Array:
        """Position of the handle in the last control period, m: an array of x, y and z."""
        return self._inner.position_m

    @property
    def force_n(self) -> Array:
        """Force on the hand in the last control period, N: an array of x, y and z; 0 once the loop has ended."""
        return self._inner.force_n

    @property
    def account_j(self) -> float:
        """Energy in the guard's account, J: what the hand may still get out."""
        return self._inner.account_j

    @property
    def ticks(self) -> int:
        """Number of control periods so far."""
        return self._inner.ticks

    @property
    def is_running(self) -> bool:
        """Whether the motors are on."""
        return self._inner.is_running

    @property
    def fault(self) -> str | None:
        """Why the loop ended by itself; ``None`` while it runs, and after ``close`` in order."""
        return self._inner.fault

    @property
    def lateness(self) -> tuple[int, float] | None:
        """After ``close``: number of control periods that were left out, and the latest by how much, s."""
        return self._inner.lateness

    @property
    def name(self) -> str:
        """Name of the device."""
        return self._inner.name

    @property
    def rate_hz(self) -> int:
        """Control rate, Hz."""
        return self._inner.rate_hz

    @property
    def force_limit_n(self) -> float:
        """Largest force, N."""
        return self._inner.force_limit_n

    @property
    def wall(self) -> str:
        """Description of the wall: object, stiffness, source of its settings."""
        return self._inner.wall

    def close(self) -> None:
        """Switches force and motors off, and waits until they are. Raises ``MayBeOn`` if the device did not confirm that."""
        said = self._inner.close()
        self._end.detach()
        if said is not None and said.startswith("THE MOTORS MAY STILL BE ON"):
            raise MayBeOn(said, 1)

    def __enter__(self) -> HapticDevice:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _three(values: Any) -> Array:
    return numpy.ascontiguousarray(values, dtype=numpy.float64).reshape(-1)
