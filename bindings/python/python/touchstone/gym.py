"""Gymnasium environments with a simulated knob: press a wall, find a detent, hold an angle against noise.

The agent is the hand: its action is a torque on the knob. The knob's motor renders Touchstone's wall, or a torque that the energy guard bounds, at
1 kHz. A step of an environment is ten control periods (ticks) of 1 ms. Importing this module registers ``touchstone/Press-v0``,
``touchstone/FindDetent-v0`` and ``touchstone/Hold-v0``.

    >>> import gymnasium, touchstone.gym
    >>> press = gymnasium.make("touchstone/Press-v0")
    >>> observation, info = press.reset(seed=1)
    >>> observation, reward, terminated, truncated, info = press.step([0.5])
"""

from __future__ import annotations

import abc
import math
from typing import Any

import gymnasium
import numpy
import numpy.typing

from ._native import Guard
from ._wall import Wall

Observation = numpy.typing.NDArray[numpy.float32]

RATE_HZ = 1000
TICKS_PER_STEP = 10
STEPS_PER_EPISODE = 300
INERTIA_KG_M2 = 1e-4
DAMPING_N_M_S_PER_RAD = 1e-3
HAND_TORQUE_N_M = 0.2
MOTOR_TORQUE_N_M = 0.5
COUNTS_PER_REV = 40_000
COUNT_RAD = 2 * math.pi / COUNTS_PER_REV
#: Largest angle of the knob on either side of 0, rad; an episode ends beyond it.
RANGE_RAD = math.pi
FASTEST_RAD_PER_S = 100.0


class Knob:
    """A simulated knob with inertia and damping. Its motion over 1 ms under a constant torque is calculated exactly."""

    def __init__(self, angle_rad: float = 0.0) -> None:
        self.angle_rad, self.speed_rad_per_s = angle_rad, 0.0
        self._count = self.count
        self._decay = math.exp(-DAMPING_N_M_S_PER_RAD / INERTIA_KG_M2 / RATE_HZ)

    def advance(self, torque_n_m: float) -> None:
        """Moves the knob by one control period (1 ms) under a constant torque, N·m."""
        final = torque_n_m / DAMPING_N_M_S_PER_RAD
        before, self.speed_rad_per_s = self.speed_rad_per_s, final + (self.speed_rad_per_s - final) * self._decay
        self.angle_rad += final / RATE_HZ + (before - self.speed_rad_per_s) * INERTIA_KG_M2 / DAMPING_N_M_S_PER_RAD

    @property
    def count(self) -> int:
        """The encoder count at the knob's angle."""
        return math.floor(self.angle_rad / COUNT_RAD + 0.5)

    def moved_rad(self) -> float:
        """Measured displacement since the last call, rad."""
        before, self._count = self._count, self.count
        return (self._count - before) * COUNT_RAD


def _guard() -> Guard:
    return Guard(
        rate_hz=RATE_HZ,
        force_limit_n_m=MOTOR_TORQUE_N_M,
        count_rad=COUNT_RAD,
        damping_n_m_s_per_rad=DAMPING_N_M_S_PER_RAD,
        # In this simulation there is no delay: a torque acts from the moment of the reading that it is calculated from.
        delay_s=0.0,
        overspeed_rad_per_s=FASTEST_RAD_PER_S,
    )


class _AtTheKnob(gymnasium.Env[Observation, numpy.typing.ArrayLike], abc.ABC):
    """Base class of the environments. An observation is the knob's angle (rad) and speed (rad/s), the motor's torque (N·m), and the goal of the task."""

    metadata = {"render_modes": []}

    def __init__(self) -> None:
        most = numpy.array([2 * RANGE_RAD, 10 * FASTEST_RAD_PER_S, MOTOR_TORQUE_N_M, 2 * RANGE_RAD], dtype=numpy.float32)
        self._most = most
        self.observation_space = gymnasium.spaces.Box(-most, most)
        #: The hand's torque as a fraction (-1 to 1) of HAND_TORQUE_N_M.
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), dtype=numpy.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        self._steps, self._motor_n_m = 0, 0.0
        self._knob = Knob(self._begin())
        return self._observed(), {}

    def step(self, action: numpy.typing.ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        share = float(numpy.asarray(action, dtype=float).reshape(-1)[0])
        if math.isnan(share):
            raise ValueError("action is not a number: give a share of the hand's torque from -1 to 1")
        hand = HAND_TORQUE_N_M * max(-1.0, min(1.0, share))
        for _ in range(TICKS_PER_STEP):
            self._motor_n_m = self._motor()
            self._knob.advance(hand + self._motor_n_m + self._disturbance())
        self._steps += 1
        away = abs(self._knob.angle_rad) > RANGE_RAD
        error = self._error()
        reward = -1.0 if away else math.exp(-abs(error))
        return self._observed(), reward, away, self._steps >= STEPS_PER_EPISODE, {"error": error, "account_j": self._account_j()}

    def _observed(self) -> Observation:
        seen = [self._knob.angle_rad, self._knob.speed_rad_per_s, self._motor_n_m, self._goal()]
        return numpy.clip(numpy.array(seen, dtype=numpy.float32), -self._most, self._most)

    def _disturbance(self) -> float:
        return 0.0

    @abc.abstractmethod
    def _begin(self) -> float:
        """Draws the random values of an episode; returns the knob's first angle, rad."""

    @abc.abstractmethod
    def _motor(self) -> float:
        """The motor's torque in the coming control period, N·m."""

    @abc.abstractmethod
    def _goal(self) -> float:
        """The goal that the agent observes: a torque in N·m or an angle in rad."""

    @abc.abstractmethod
    def _error(self) -> float:
        """Distance from the goal, divided by the tolerance of the task."""

    @abc.abstractmethod
    def _account_j(self) -> float | None:
        """Energy in the guard's account, which the hand may still get out, J; None without a guard."""


class Press(_AtTheKnob):
    """Task: press a virtual wall with a given torque. The error is the motor's resisting torque minus the given torque, in tenths of the given torque."""

    def __init__(self, stiffness_n_m_per_rad: float = 1.0) -> None:
        super().__init__()
        self._settings = {
            "wall.k_desired_n_m_per_rad": stiffness_n_m_per_rad,
            "law.estimator.inertia_kg_m2": INERTIA_KG_M2,
            "law.estimator.damping_n_m_s_per_rad": DAMPING_N_M_S_PER_RAD,
        }

    def _begin(self) -> float:
        self._torque_n_m = float(self.np_random.uniform(0.02, 0.15))
        self._surface_rad = float(self.np_random.uniform(0.2, 0.8))
        self._wall = Wall(self._settings, counts_per_rev=COUNTS_PER_REV, surface_rad=self._surface_rad)
        return 0.0

    def _motor(self) -> float:
        return self._wall.tick_count(self._knob.count)

    def _goal(self) -> float:
        return self._torque_n_m

    def _error(self) -> float:
        return (-self._motor_n_m - self._torque_n_m) / (0.1 * self._torque_n_m)

    def _account_j(self) -> float | None:
        return self._wall.account_j


class _Guarded(_AtTheKnob):
    """Base class of the environments in which the energy guard bounds the motor's requested torque."""

    def _begin(self) -> float:
        self._behind = _guard()
        return 0.0

    @abc.abstractmethod
    def _wanted(self) -> float:
        """The torque that the environment requests from the guard, N·m."""

    def _motor(self) -> float:
        wanted = self._wanted()
        # The guard counts a torque that resists a motion as positive.
        return -self._behind.tick(self._knob.moved_rad(), -wanted)

    def _account_j(self) -> float:
        return self._behind.account_j


class FindDetent(_Guarded):
    """Task: come to rest in the one deep detent among shallow ones. The goal is the deep detent's torque; the agent must find its angle by feel."""

    WIDTH_RAD = 0.2
    DEEP_N_M, SHALLOW_N_M = 0.1, 0.02

    def _begin(self) -> float:
        self._deep = int(self.np_random.integers(2, 9)) * (1 if self.np_random.random() < 0.5 else -1)
        return super()._begin()

    def _wanted(self) -> float:
        place = self._knob.angle_rad / self.WIDTH_RAD
        nearest = math.floor(place + 0.5)
        most = self.DEEP_N_M if nearest == self._deep else self.SHALLOW_N_M
        return -most * math.sin(2 * math.pi * (place - nearest))

    def _goal(self) -> float:
        return self.DEEP_N_M

    def _error(self) -> float:
        return self._knob.angle_rad / self.WIDTH_RAD - self._deep


class Hold(_Guarded):
    """Task: hold an angle while the motor gives random torques of 30 mN·m rms through the guard. The error is in hundredths of a radian."""

    NOISE_N_M = 0.03

    def _begin(self) -> float:
        self._angle_rad = float(self.np_random.uniform(-1.0, 1.0))
        super()._begin()
        return self._angle_rad

    def _wanted(self) -> float:
        return float(self.np_random.normal(0.0, self.NOISE_N_M))

    def _goal(self) -> float:
        return self._angle_rad

    def _error(self) -> float:
        return (self._knob.angle_rad - self._angle_rad) / 0.01


gymnasium.register("touchstone/Press-v0", entry_point="touchstone.gym:Press")
gymnasium.register("touchstone/FindDetent-v0", entry_point="touchstone.gym:FindDetent")
gymnasium.register("touchstone/Hold-v0", entry_point="touchstone.gym:Hold")
