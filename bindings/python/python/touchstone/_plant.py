"""The two halves of a scene, step by step: device with hand, and control law. With both in one loop they give the numbers of ``run``, bit for bit."""

from __future__ import annotations

import json
from typing import Any

from . import _native
from ._errors import Mistake
from ._program import Changes, Scene, _ask, _Scene
from ._text import text


def _changed(changes: Changes) -> list[str]:
    return [f"{path}={text(value)}" for path, value in (changes or {}).items()]


def _space_json(scene: Scene) -> str:
    """The completed scene of three axes as JSON; errors are those of the program."""
    with _Scene(scene) as name:
        return json.dumps(_ask("run", name, "--print"))


class Plant(_native.Plant):
    """Device and hand of a scene of one axis, without its control law: give the motor's torque for every control period.

    ``scene`` and ``changes`` are those of ``run``. Raises ``Mistake`` that names place, problem and remedy for a wrong scene, ``ValueError`` for
    a torque that is no number or beyond ±1e6 N·m, and ``OverflowError`` once the device is too far away for a number.

        >>> plant, law = Plant("thesis-knob"), Law("thesis-knob")
        >>> for _ in range(plant.scene_steps):
        ...     torque = law.tick(plant.angle_rad, plant.changed_at_rad)
        ...     angle = plant.step(torque)
    """

    def __new__(cls, scene: Scene = "thesis-knob", changes: Changes = None) -> Plant:
        try:
            with _Scene(scene) as name:
                return super().__new__(cls, name, _changed(changes))
        except ValueError as wrong:
            raise Mistake(str(wrong), 2) from None


class Law(_native.Law):
    """The controller of a scene of one axis: sensor, control law, guard and the effects on the torque command.

    ``Wall`` is the control law alone, from an encoder's count. Raises ``Mistake`` for a wrong scene, ``ValueError`` for an angle that is no
    number or beyond ±1e6 rad.
    """

    def __new__(cls, scene: Scene = "thesis-knob", changes: Changes = None) -> Law:
        try:
            with _Scene(scene) as name:
                return super().__new__(cls, name, _changed(changes))
        except ValueError as wrong:
            raise Mistake(str(wrong), 2) from None


class SpacePlant(_native.SpacePlant):
    """Device and hand of a scene of three axes: give the force on the hand for every control period of 1 ms.

    ``scene`` is ``"delta-ball"``, a path or a dict with ``dof = 3``. Positions in m and forces in N are arrays of shape ``(3,)``: x, y and z.
    Raises ``Mistake`` for a wrong scene, ``ValueError`` for an array of another shape or with a number that is not finite, and
    ``OverflowError`` where the mechanism cannot go.

        >>> plant, wall = SpacePlant("delta-ball"), SpaceWall("delta-ball")
        >>> for _ in range(plant.scene_steps):
        ...     force = plant.step(wall.tick(plant.measured_m))
    """

    def __new__(cls, scene: Scene = "delta-ball") -> SpacePlant:
        return super().__new__(cls, _space_json(_of_three(scene)))


class SpaceWall(_native.SpaceWall):
    """The wall of a scene of three axes: object, control law and, for the approach ``shipped``, estimator and guard. Same scenes as ``SpacePlant``."""

    def __new__(cls, scene: Scene = "delta-ball") -> SpaceWall:
        return super().__new__(cls, _space_json(_of_three(scene)))


def _of_three(scene: Any) -> Scene:
    # `touchstone run --print` also accepts a scene of one axis, so that a missing `dof` is reported here.
    if isinstance(scene, dict) and "dof" not in scene:
        raise Mistake("dof: the scene has no such field; give dof = 3, or use Plant and Law for one axis", 2)
    given: Scene = scene
    return given
