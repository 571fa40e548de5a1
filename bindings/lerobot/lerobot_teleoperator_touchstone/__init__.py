"""A haptic device as a LeRobot teleoperator, with Touchstone's wall and energy guard. Importing this package registers ``--teleop.type=touchstone``."""

from .config_touchstone import TouchstoneTeleopConfig
from .touchstone_teleop import TouchstoneTeleop

__all__ = ["TouchstoneTeleop", "TouchstoneTeleopConfig"]
