"""Tests the example of a knob in MuJoCo with the energy guard in its loop. Skipped without mujoco."""

import runpy
from pathlib import Path

import pytest

pytest.importorskip("mujoco")


def test_the_guard_bounds_a_contact_that_gains_energy():
    example = runpy.run_path(str(Path(__file__).parents[1] / "examples" / "mujoco_knob.py"))
    thrown, free = example["throw"](guarded=False)
    _, bounded = example["throw"](guarded=True)
    allowed = thrown + example["CAPACITY_J"] + 0.0005 * 5.0
    assert free > allowed, "without the guard the contact gives more"
    assert bounded <= allowed
