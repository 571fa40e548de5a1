"""Tests ``HapticDevice`` with the simulated device, a stand-in for Haply's service and, if TOUCHSTONE_MOCK_DHD names it, the mock of Force Dimension's library.

The loop is that of ``touchstone device run``, whose faults have tests of their own in Rust.
"""

import gc
import os
import subprocess
import sys
import time

import numpy
import pytest
import touchstone
from haply_stand_in import HaplyService

# A busy machine must not end the loop; a real device keeps the default of 10 ms.
CALM = dict(late_limit_s=1.0, priority=False)


def wait_for(what, seconds=10.0):
    end = time.monotonic() + seconds
    while not what():
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.002)


def faded_in(device):
    wait_for(lambda: device.ticks > 1000)


def pushed_down(wall):
    """The handle's height, m, after a follower has pushed it down by 4 N for half a second, from a plane's surface."""
    with touchstone.HapticDevice("simulated", wall=wall, hand_m=[0.0, 0.0, 0.0], **CALM) as device:
        assert device.rate_hz == 1000
        assert wall is None or "25 N/mm" in device.wall
        faded_in(device)
        end = time.monotonic() + 0.5
        while time.monotonic() < end:
            device.send_force([0.0, 0.0, -4.0])
            time.sleep(0.01)
        force, place = device.force_n, device.position_m
    assert force.shape == place.shape == (3,)
    assert not device.is_running and device.fault is None
    missed, worst_s = device.lateness
    assert missed >= 0 and worst_s >= 0.0
    assert device.force_n.tolist() == [0.0, 0.0, 0.0]
    return place[2]


def test_a_wall_holds_against_a_follower():
    # The hand (0.3 N/mm in series with its pad's 2 N/mm) has 0.26 N/mm, the wall 25 N/mm.
    assert -1e-3 < pushed_down("plane") < 0.0
    assert pushed_down(None) < -4e-3


def test_a_handle_that_begins_deep_inside_is_not_thrown_out():
    # Pushing the handle out would give the hand more energy than the guard allows.
    with touchstone.HapticDevice("simulated", wall="plane", hand_m=[0.0, 0.0, -0.02], **CALM) as device:
        faded_in(device)
        assert device.position_m[2] < -0.015


def test_a_followers_force_moves_the_hand_and_fades_without_a_newer_one():
    with touchstone.HapticDevice("simulated", hand_m=[0.0, 0.0, 0.0], **CALM) as device:
        faded_in(device)
        begun = device.position_m
        end = time.monotonic() + 0.5
        while time.monotonic() < end:
            device.send_force([1.5, 0.0, 0.0])
            time.sleep(0.01)
        assert device.force_n[0] == pytest.approx(1.5, abs=1e-4)
        assert device.position_m[0] - begun[0] > 2e-3
        device.send_force([1.5, 0.0, 0.0])
        sent = time.monotonic()
        # The force acts in full for 50 ms, and is 0 after 100 ms. The longer limit is for a machine that runs the threads late.
        wait_for(lambda: not device.force_n.any(), seconds=0.4)
        assert time.monotonic() - sent > 0.05


def test_a_force_that_is_old_when_it_comes_acts_no_more():
    with touchstone.HapticDevice("simulated", **CALM) as device:
        faded_in(device)
        for _ in range(50):
            device.send_force([1.5, 0.0, 0.0], age_s=0.11)
            time.sleep(0.002)
            assert not device.force_n.any()


def test_a_follower_without_end_gives_a_free_device_what_the_guard_allows():
    """The follower pushes by 8 N for ever. 40 mJ move 0.148 kg at 0.735 m/s; without the guard it would reach the edge at some 2 m/s."""
    with touchstone.HapticDevice("simulated", hand_m=None, stale_after_s=1.0, **CALM) as device:
        faded_in(device)
        fastest, least, before = 0.0, 1.0, (device.ticks, device.position_m)
        end = time.monotonic() + 0.3
        while time.monotonic() < end and device.is_running:
            device.send_force([8.0, 0.0, 0.0])
            ticks, place = device.ticks, device.position_m
            if ticks > before[0] + 5:
                fastest = max(fastest, numpy.linalg.norm(place - before[1]) / (ticks - before[0]) * 1000)
                before = ticks, place
            least = min(least, device.account_j)
            time.sleep(0.001)
    assert least < 0.005, "the account was used up"
    # Position and tick are read one after the other, so a tick may lie between them.
    assert 0.3 < fastest < 0.735 * 1.25


def test_a_stand_in_for_haplys_service_gets_the_forces_and_none_at_the_end():
    service = HaplyService()
    with touchstone.HapticDevice("inverse3", service=service.address, **CALM) as device:
        assert device.name.startswith("Inverse3 049D")
        assert device.force_limit_n == 3.0
        faded_in(device)
        for _ in range(20):
            device.send_force([0.0, 0.4, 0.0])
            time.sleep(0.01)
        assert service.last_n[1] > 0.1
    service.thread.join(5)
    assert service.last_n == [0.0, 0.0, 0.0]
    assert device.position_m[1] > 1e-3, "the handle moved, and its place was read"


def test_a_lost_device_is_a_fault_that_says_what_to_do():
    service = HaplyService()
    device = touchstone.HapticDevice("inverse3", service=service.address, **CALM)
    service.gone = True
    wait_for(lambda: not device.is_running)
    with pytest.raises(touchstone.Failed, match="check its supply"):
        device.send_force([0.0, 0.0, 0.0])
    assert not device.force_n.any()
    # Nothing confirmed that the last force has ended.
    with pytest.raises(touchstone.MayBeOn, match="MAY STILL BE ON"):
        device.close()


def test_the_mock_of_force_dimensions_library_is_driven():
    library = os.environ.get("TOUCHSTONE_MOCK_DHD")
    if not library:
        pytest.skip("TOUCHSTONE_MOCK_DHD names no mock: cargo build --release -p touchstone-mock-dhd")
    with touchstone.HapticDevice("omega3", wall="plane", library=library, **CALM) as device:
        faded_in(device)
        assert "omega" in device.name.lower()
    assert device.fault is None


@pytest.mark.parametrize(
    "changes, says",
    [
        (dict(device="omega9"), 'device = "omega9": give "omega3"'),
        (dict(wall="cube"), 'wall = "cube": give "plane"'),
        (dict(rate_hz=50), "rate_hz = 50: give 100 to 10000"),
        (dict(stiffness_n_per_mm=-1.0), "stiffness_n_per_mm = -1"),
        (dict(force_limit_n=float("nan")), "force_limit_n = NaN"),
        (dict(stale_after_s=2.0), "stale_after_s = 2: give 0 to 1 s"),
        (dict(hand_m=[0.0, 1.0]), "hand_m has 2 numbers"),
    ],
)
def test_a_mistake_is_named(changes, says):
    with pytest.raises(touchstone.Mistake) as error:
        touchstone.HapticDevice(**{"device": "simulated", **changes})
    assert says in str(error.value)


def test_what_cannot_be_opened_is_named():
    with pytest.raises(touchstone.Failed, match="rate_hz = 500: simulated omega.3 does 1000 to 4000 Hz"):
        touchstone.HapticDevice("simulated", rate_hz=500)
    with pytest.raises(touchstone.Failed, match="127.0.0.1:1"):
        touchstone.HapticDevice("inverse3", service="127.0.0.1:1")
    with pytest.raises(touchstone.Failed, match="no-such-library"):
        touchstone.HapticDevice("omega3", library="/no-such-library.so")


def test_a_force_of_no_sense_is_refused_and_the_loop_goes_on():
    with touchstone.HapticDevice("simulated", **CALM) as device:
        for wrong in ([0.0, float("nan"), 0.0], [float("inf"), 0.0, 0.0], [1.0, 2.0]):
            with pytest.raises(ValueError, match="force_n"):
                device.send_force(wrong)
        with pytest.raises(ValueError, match="age_s = -1"):
            device.send_force([0.0, 0.0, 0.0], age_s=-1.0)
        assert device.is_running
    with pytest.raises(touchstone.Failed, match="closed"):
        device.send_force([0.0, 0.0, 0.0])
    device.close()


def test_a_forgotten_device_is_switched_off():
    service = HaplyService()
    device = touchstone.HapticDevice("inverse3", service=service.address, **CALM)
    del device
    gc.collect()
    service.thread.join(5)
    assert not service.thread.is_alive()
    service = HaplyService()
    program = "import sys, touchstone; kept = touchstone.HapticDevice('inverse3', service=sys.argv[1], late_limit_s=1.0, priority=False)"
    subprocess.run([sys.executable, "-c", program, service.address], check=True, timeout=30)
    service.thread.join(5)
    assert not service.thread.is_alive() and service.last_n == [0.0, 0.0, 0.0]
