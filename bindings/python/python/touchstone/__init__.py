"""Hard virtual walls for haptic devices, and an energy guard for any force.

``Guard`` bounds the energy that a hand can get out of a device, whatever force is requested. ``Wall`` is a virtual wall, computed one control
period per call, with the firmware's results to the last bit. ``run``, ``scorecard``, ``tune`` and ``certify`` run the simulator: the program
``touchstone``, which this package contains.

    >>> import touchstone
    >>> wall = touchstone.Wall({"wall.k_desired_n_m_per_rad": 5})
    >>> round(wall.tick(0.01), 4)  # 10 mrad inside: 50 mN·m outwards
    0.05
"""

from ._board import Board
from ._campaign import campaign
from ._device import Device, GuardedDevice
from ._errors import Failed, MayBeOn, Mistake, NotMet
from ._haptic import HapticDevice
from ._native import Guard, SpaceGuard, __version__
from ._plant import Law, Plant, SpacePlant, SpaceWall
from ._program import (
    Run,
    certify,
    program,
    run,
    scenes,
    scorecard,
    tune,
)
from ._sweep import Sweep, sweep
from ._wall import Wall

__all__ = [
    "Board",
    "Device",
    "Failed",
    "Guard",
    "GuardedDevice",
    "HapticDevice",
    "Law",
    "MayBeOn",
    "Mistake",
    "NotMet",
    "Plant",
    "Run",
    "SpaceGuard",
    "SpacePlant",
    "SpaceWall",
    "Sweep",
    "Wall",
    "__version__",
    "campaign",
    "certify",
    "program",
    "run",
    "scenes",
    "scorecard",
    "sweep",
    "tune",
]
