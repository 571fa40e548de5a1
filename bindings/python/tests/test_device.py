"""Tests ``GuardedDevice`` with a teleoperation handle whose follower's forces arrive late."""

import dataclasses
import math

import pytest
import touchstone

STEP = 1e-3


class Handle:
    """A simulated handle of 1e-3 kg·m² with little damping, which a hand throws and lets go."""

    def __init__(self, speed=5.0):
        self.angle, self.speed, self.torque = 0.0, speed, 0.0

    def read(self):
        return self.angle

    def write(self, torque):
        self.torque = torque

    def move(self):
        for _ in range(10):
            self.speed += (self.torque - 2e-3 * self.speed) / 1e-3 * STEP / 10
            self.angle += self.speed * STEP / 10

    @property
    def energy(self):
        return 0.5 * 1e-3 * self.speed**2


SETTINGS = dict(
    rate_hz=1000, force_limit_n_m=2.0, count_rad=1e-6, damping_n_m_s_per_rad=2e-3, delay_s=0.0, capacity_j=0.05, refill_w=0.0, overspeed_rad_per_s=50
)


def most_energy(write_of, ticks=3000, late=20):
    """Simulates the handle on a spring whose force acts 20 ms late, so that the handle gains energy with every swing. Returns the handle's largest energy, J."""
    handle = Handle()
    step = write_of(handle)
    past = [0.0] * late
    most = 0.0
    for _ in range(ticks):
        past.append(-2.0 * handle.angle)
        step(past[-late])
        handle.move()
        most = max(most, handle.energy)
    return most


def test_a_late_follower_gains_energy_and_the_guard_bounds_it():
    def direct(handle):
        return lambda wanted: handle.write(max(-2.0, min(2.0, wanted)))

    def guarded(handle):
        return touchstone.GuardedDevice(handle.read, handle.write, **SETTINGS).step

    thrown = Handle().energy
    assert most_energy(direct) > 10 * thrown
    assert most_energy(guarded) <= thrown + 0.05


def test_a_force_that_is_too_old_counts_as_none():
    handle = Handle(speed=0.0)
    device = touchstone.GuardedDevice(handle.read, handle.write, stale_after_s=0.01, **SETTINGS)
    assert device.step(0.5, age_s=0.01) == pytest.approx(0.5, abs=1e-6)
    assert device.step(0.5, age_s=0.011) == 0.0
    assert device.step(0.5, age_s=math.nan) == 0.0
    assert device.stale_steps == 2


def test_a_broken_read_leaves_the_motor_off():
    handle = Handle(speed=0.0)

    def read():
        if handle.torque:
            raise OSError("unplugged")
        return 0.0

    device = touchstone.GuardedDevice(read, handle.write, **SETTINGS)
    device.step(0.5)
    assert handle.torque > 0.4
    with pytest.raises(OSError, match="unplugged"):
        device.step(0.5)
    assert handle.torque == 0.0
    device.resume()
    assert device.guard.account_j <= 0.0
    assert device.step(0.1) == 0.0, "an account without refill stays empty"


def test_switching_off_in_order_keeps_the_account():
    handle = Handle(speed=0.0)
    device = touchstone.GuardedDevice(handle.read, handle.write, **SETTINGS)
    device.step(0.1)
    device.off()
    assert handle.torque == 0.0
    device.resume()
    assert device.step(0.1) == pytest.approx(0.1, abs=1e-6)


def test_a_force_that_is_no_number_leaves_the_motor_off():
    handle = Handle(speed=0.0)
    with touchstone.GuardedDevice(handle.read, handle.write, **SETTINGS) as device:
        device.step(0.3)
        with pytest.raises(ValueError, match="not a number"):
            device.step(math.nan)
        assert handle.torque == 0.0


def test_overspeed_writes_no_force():
    handle = Handle(speed=0.0)
    device = touchstone.GuardedDevice(handle.read, handle.write, **SETTINGS)
    device.step(0.3)
    handle.angle = 1.0
    assert device.step(0.3) == 0.0
    assert device.guard.tripped


KNOB = touchstone.Device(
    rate_hz=1000, inertia_kg_m2=1e-3, damping_n_m_s_per_rad=2e-3, counts_per_rev=6_283_185, force_limit_n_m=2.0, delay_s=2e-4, lag_s=1e-4
)


def test_the_guards_settings_follow_from_the_device():
    settings = KNOB.guard_settings(capacity_j=0.01)
    assert settings.pop("count_rad") == pytest.approx(1e-6, rel=1e-6)
    assert settings == dict(rate_hz=1000, force_limit_n_m=2.0, damping_n_m_s_per_rad=2e-3, delay_s=2e-4, lag_s=1e-4, capacity_j=0.01)
    assert KNOB.kinetic_energy_j(5.0) == Handle(speed=5.0).energy


def test_a_device_and_its_properties_are_two_functions_and_keywords():
    one, other = Handle(), Handle()
    short = touchstone.GuardedDevice(one, KNOB, capacity_j=0.05)
    long = touchstone.GuardedDevice(other.read, other.write, **KNOB.guard_settings(capacity_j=0.05))
    for tick in range(200):
        wanted = math.sin(tick)
        assert short.step(wanted) == long.step(wanted)
        one.move()
        other.move()
    assert short.force_limit == 2.0


def test_a_delay_costs_account():
    """Without the delay from the device's properties the guard would allow more."""
    quick = touchstone.GuardedDevice(Handle(), dataclasses.replace(KNOB, delay_s=0.0, lag_s=0.0), overspeed_rad_per_s=50)
    late = touchstone.GuardedDevice(Handle(), KNOB, overspeed_rad_per_s=50)
    forces = [[device.step((-1.0) ** tick) for tick in range(50)] for device in (quick, late)]
    assert sum(map(abs, forces[1])) < 0.9 * sum(map(abs, forces[0]))


def test_a_device_of_no_sense_is_refused():
    with pytest.raises(ValueError, match="rate_hz"):
        touchstone.GuardedDevice(Handle(), dataclasses.replace(KNOB, rate_hz=0))
    with pytest.raises(ValueError, match="counts_per_rev = 0"):
        dataclasses.replace(KNOB, counts_per_rev=0)
    with pytest.raises(ValueError, match="inertia_kg_m2 = -1"):
        dataclasses.replace(KNOB, inertia_kg_m2=-1.0)
