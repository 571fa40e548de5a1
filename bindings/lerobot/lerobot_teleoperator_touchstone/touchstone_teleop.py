"""The teleoperator: the handle's position is the action, the follower's force is the feedback."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

from lerobot.teleoperators import Teleoperator
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError
from touchstone import Failed, HapticDevice

from .config_touchstone import TouchstoneTeleopConfig

ACTION = ("x_m", "y_m", "z_m")
FEEDBACK = ("force_x_n", "force_y_n", "force_z_n")
#: An optional key of the feedback: the time since the force was measured, s.
AGE = "age_s"


class TouchstoneTeleop(Teleoperator):
    """An omega.3 or Inverse3 whose wall and energy guard run in a thread of their own.

    **The motors are on** from ``connect`` to ``disconnect``. Positions and forces are in the device's own frame.
    """

    config_class = TouchstoneTeleopConfig
    name = "touchstone"

    def __init__(self, config: TouchstoneTeleopConfig) -> None:
        super().__init__(config)
        self.config = config
        self._device: HapticDevice | None = None

    @cached_property
    def action_features(self) -> dict[str, type]:
        return dict.fromkeys(ACTION, float)

    @cached_property
    def feedback_features(self) -> dict[str, type]:
        return dict.fromkeys(FEEDBACK, float)

    @property
    def is_connected(self) -> bool:
        # The base class reads this property also after a constructor that failed. `_device` may not exist then.
        device = getattr(self, "_device", None)
        return device is not None and device.is_running

    def connect(self, calibrate: bool = True) -> None:
        """Opens the device and switches its motors on. Raises ``touchstone.Mistake`` for a wrong setting, ``touchstone.Failed`` without a device."""
        if self.is_connected:
            raise DeviceAlreadyConnectedError(f"{self} is already connected")
        self._close()
        config = self.config
        self._device = HapticDevice(
            config.device,
            wall=None if config.wall == "none" else config.wall,
            rate_hz=config.rate_hz,
            stiffness_n_per_mm=config.stiffness_n_per_mm,
            force_limit_n=config.force_limit_n,
            stale_after_s=config.stale_after_s,
            fade_s=config.fade_s,
            late_limit_s=config.late_limit_s,
            library=config.library,
            service=config.service,
            priority=config.priority,
        )

    @property
    def is_calibrated(self) -> bool:
        """Always true: ``connect`` refuses a device that its maker's program has not calibrated."""
        return True

    def calibrate(self) -> None:
        """Does nothing: the maker's program calibrates the device."""

    def configure(self) -> None:
        """Does nothing: ``connect`` uses all settings."""

    def get_action(self) -> dict[str, float]:
        """Position of the handle, m. Raises ``DeviceNotConnectedError`` with the reason if the loop has ended."""
        return dict(zip(ACTION, self._running().position_m.tolist()))

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Gives the follower's force on the hand, N, to the guard. It acts until a newer one comes, or it is too old (``stale_after_s``, ``fade_s``).

        Raises ``ValueError`` for a missing or unknown key, or a value that is no finite number; the force before stays and fades.
        """
        device = self._running()
        unknown = [key for key in feedback if key not in (*FEEDBACK, AGE)]
        missing = [key for key in FEEDBACK if key not in feedback]
        if unknown or missing:
            raise ValueError(f"feedback: unknown keys {unknown}, missing keys {missing}; give {', '.join(FEEDBACK)} and, if known, {AGE}")
        force, age = [float(feedback[key]) for key in FEEDBACK], float(feedback.get(AGE, 0.0))
        for key, value in zip((*FEEDBACK, AGE), (*force, age)):
            if not math.isfinite(value):
                raise ValueError(f"feedback: {key} = {value}; give a finite number")
        try:
            device.send_force(force, age)
        except Failed as ended:
            raise DeviceNotConnectedError(str(ended)) from ended

    def disconnect(self) -> None:
        """Switches force and motors off, and waits until they are. Raises ``touchstone.MayBeOn`` if the device does not confirm that."""
        if self._device is None:
            raise DeviceNotConnectedError(f"{self} is not connected: call connect() first")
        self._close()

    def _close(self) -> None:
        device, self._device = self._device, None
        if device is not None:
            device.close()

    def _running(self) -> HapticDevice:
        if self._device is None:
            raise DeviceNotConnectedError(f"{self} is not connected: call connect() first")
        if not self._device.is_running:
            raise DeviceNotConnectedError(f"{self}: {self._device.fault}; the motors are off; call disconnect() and connect()")
        return self._device
