"""Tests the plugin with the real package lerobot and the simulated device. Skipped, with the reason, where lerobot or the plugin is not installed."""

import dataclasses
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("lerobot", reason="LeRobot is absent: pip install lerobot")
pytest.importorskip("touchstone", reason="the wheel touchstone-haptics is absent: cargo xtask wheel")
pytest.importorskip("lerobot_teleoperator_touchstone", reason="the plugin is absent: pip install ./bindings/lerobot")

import draccus
import touchstone
from lerobot.teleoperators import TeleoperatorConfig, make_teleoperator_from_config
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError
from lerobot.utils.import_utils import register_third_party_plugins
from lerobot_teleoperator_touchstone import TouchstoneTeleop, TouchstoneTeleopConfig

sys.path.insert(0, str(Path(__file__).parents[2] / "python" / "tests"))
from haply_stand_in import HaplyService  # noqa: E402

PUSH = {"force_x_n": 1.5, "force_y_n": 0.0, "force_z_n": 0.0}


@dataclasses.dataclass
class Options:
    """The options of a program, as LeRobot's own have them."""

    teleop: TeleoperatorConfig


def config(folder, **changes):
    # A busy machine must not end the loop.
    return TouchstoneTeleopConfig(**{"id": "test", "calibration_dir": folder, "device": "simulated", "late_limit_s": 1.0, "priority": False, **changes})


@pytest.fixture
def hand(tmp_path):
    hand = TouchstoneTeleop(config(tmp_path))
    hand.connect()
    yield hand
    if hand.is_connected:
        hand.disconnect()


def wait_for(what, seconds=10.0):
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.002)


def faded_in(hand):
    wait_for(lambda: hand._device.ticks > 1000)


def test_lerobot_finds_the_plugin_by_its_name_and_makes_it_from_options(tmp_path):
    register_third_party_plugins()
    assert TeleoperatorConfig.get_choice_class("touchstone") is TouchstoneTeleopConfig
    options = ["type=touchstone", "id=hand", f"calibration_dir={tmp_path}", "device=simulated", "wall=sphere", "stiffness_n_per_mm=2.5"]
    asked = draccus.parse(Options, args=[f"--teleop.{option}" for option in options]).teleop
    assert (asked.wall, asked.stiffness_n_per_mm, asked.library) == ("sphere", 2.5, None)
    made = make_teleoperator_from_config(asked)
    assert type(made) is TouchstoneTeleop
    assert str(made) == "hand TouchstoneTeleop"
    assert made.is_calibrated and not made.is_connected


def test_an_action_is_the_handles_place(hand):
    assert hand.is_connected
    action = hand.get_action()
    assert set(action) == set(hand.action_features)
    assert all(type(value) is float for value in action.values())
    assert action["z_m"] == pytest.approx(0.01, abs=1e-3)
    with pytest.raises(DeviceAlreadyConnectedError):
        hand.connect()


def test_a_followers_force_is_felt_and_nothing_after_a_tenth_of_a_second(hand):
    faded_in(hand)
    begun = hand.get_action()["x_m"]
    # LeRobot's loop of 60 Hz.
    for _ in range(30):
        hand.send_feedback(PUSH)
        time.sleep(1 / 60)
    assert hand._device.force_n[0] == pytest.approx(1.5, abs=1e-4)
    assert hand.get_action()["x_m"] > begun + 1e-3
    hand.send_feedback(PUSH)
    sent = time.monotonic()
    wait_for(lambda: not hand._device.force_n.any(), seconds=0.4)
    assert time.monotonic() - sent > 0.05
    hand.send_feedback({**PUSH, "age_s": 0.2})
    time.sleep(0.01)
    assert not hand._device.force_n.any()


def test_the_wall_and_the_guard_go_on_while_python_sleeps(tmp_path):
    hand = TouchstoneTeleop(config(tmp_path, wall="plane"))
    with hand:
        before = hand._device.ticks
        time.sleep(0.5)
        assert hand._device.ticks - before > 300
        assert "25 N/mm" in hand._device.wall
        assert 0.0 < hand._device.account_j <= 0.0401
    assert not hand.is_connected


def test_feedback_of_no_sense_is_refused(hand):
    for wrong, says in [
        ({}, "missing keys"),
        ({**PUSH, "gripper": 1.0}, "unknown keys .'gripper'"),
        ({**PUSH, "force_x_n": float("nan")}, "force_x_n = nan"),
        ({**PUSH, "age_s": float("inf")}, "age_s = inf"),
    ]:
        with pytest.raises(ValueError, match=says):
            hand.send_feedback(wrong)
    assert hand.is_connected


def test_without_connect_nothing_works(tmp_path):
    hand = TouchstoneTeleop(config(tmp_path))
    for call in (hand.get_action, hand.disconnect, lambda: hand.send_feedback(PUSH)):
        with pytest.raises(DeviceNotConnectedError, match="connect"):
            call()
    hand.connect()
    hand.disconnect()
    assert not hand.is_connected


def test_a_wrong_setting_and_an_absent_device_are_named(tmp_path):
    with pytest.raises(touchstone.Mistake, match="wall = .cube."):
        TouchstoneTeleop(config(tmp_path, wall="cube")).connect()
    with pytest.raises(touchstone.Failed, match="127.0.0.1:1"):
        TouchstoneTeleop(config(tmp_path, device="inverse3", service="127.0.0.1:1")).connect()


def test_an_inverse3_over_the_stand_in_is_driven_and_its_loss_is_told(tmp_path):
    service = HaplyService()
    hand = TouchstoneTeleop(config(tmp_path, device="inverse3", service=service.address))
    hand.connect()
    faded_in(hand)
    for _ in range(20):
        hand.send_feedback({**PUSH, "force_x_n": 0.4})
        time.sleep(0.01)
    assert service.last_n[0] > 0.1
    service.gone = True
    wait_for(lambda: not hand.is_connected)
    with pytest.raises(DeviceNotConnectedError, match="supply"):
        hand.get_action()
    with pytest.raises(touchstone.MayBeOn):
        hand.disconnect()
