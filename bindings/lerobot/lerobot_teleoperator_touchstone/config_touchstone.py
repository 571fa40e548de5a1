"""The settings of the teleoperator. Each is an option of LeRobot's programs: ``--teleop.device=omega3``."""

from __future__ import annotations

from dataclasses import dataclass

from lerobot.teleoperators import TeleoperatorConfig


@TeleoperatorConfig.register_subclass("touchstone")
@dataclass(kw_only=True)
class TouchstoneTeleopConfig(TeleoperatorConfig):
    """Settings with their defaults. A wrong value is refused by ``connect``, which names the range."""

    #: omega3, inverse3 or simulated.
    device: str = "omega3"
    #: Object in the workspace: none, plane, inclined or sphere.
    wall: str = "none"
    #: Rate of wall and guard, Hz. An Inverse3 ignores it: Haply's service sets the rate.
    rate_hz: int = 1000
    #: Stiffness of the wall, N/mm. None: the tuned wall of device and rate, else 5, or 1 for an Inverse3.
    stiffness_n_per_mm: float | None = None
    #: Largest force on the hand, N. None: the device's.
    force_limit_n: float | None = None
    #: Time for which the follower's last force acts in full, s.
    stale_after_s: float = 0.05
    #: Time in which this force then fades to 0, s.
    fade_s: float = 0.05
    #: Lateness of a control period that ends the loop, s.
    late_limit_s: float = 0.01
    #: Whether to ask for real-time priority.
    priority: bool = True
    #: Path of Force Dimension's library. None: the usual places are searched (docs/devices.md).
    library: str | None = None
    #: HOST:PORT of Haply's service. None: localhost:10001.
    service: str | None = None
