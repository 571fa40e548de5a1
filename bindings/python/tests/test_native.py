"""Tests the Python classes ``Guard`` (energy guard) and ``Wall`` (virtual wall)."""

import math
import random

import numpy
import pytest
import touchstone


def guard(**changes):
    settings = dict(rate_hz=1000, force_limit_n_m=0.5, count_rad=2e-4, damping_n_m_s_per_rad=4e-4, delay_s=0.0)
    return touchstone.Guard(**{**settings, **changes})


def test_a_wall_pushes_out_as_its_stiffness_says():
    wall = touchstone.Wall({"wall.k_desired_n_m_per_rad": 5, "law.kind": "spring", "law.states": "measured"})
    assert wall.law == "spring"
    assert wall.tick(0.01) == pytest.approx(0.05, abs=1e-6)
    assert wall.tick(-0.01) == 0.0


def test_an_array_gives_the_bits_of_single_ticks():
    places = numpy.random.default_rng(1).normal(0.0, 0.01, 20_000)
    one, many = touchstone.Wall(), touchstone.Wall()
    assert [one.tick(place) for place in places] == list(many.ticks(places))
    moved, wanted = numpy.diff(places), places[1:] * 40.0
    one, many = guard(), guard()
    assert [one.tick(*pair) for pair in zip(moved, wanted)] == list(many.ticks(moved, wanted))
    assert one.account_j == many.account_j


def test_counts_are_penetrations():
    by_count = touchstone.Wall(counts_per_rev=16_384, surface_rad=0.1)
    by_angle = touchstone.Wall(counts_per_rev=16_384)
    for count in range(250, 290):
        angle = 2 * math.pi * count / 16_384 - 0.1
        assert by_count.tick_count(count) == pytest.approx(-by_angle.tick(angle), abs=1e-5)


def energy_out(moved, forces):
    """The most energy that the hand got in any time window, J. Each force acts until the next control period."""
    worst = total = 0.0
    for step, force in zip(moved[1:], forces):
        total = max(0.0, total - force * step)
        worst = max(worst, total)
    return worst


@pytest.mark.parametrize("seed", range(8))
def test_no_window_gives_more_than_the_promise(seed):
    """Checks that a hand gets no more energy out than the guard's bound, if the control law is positive feedback that the hand exploits."""
    chance, stage = random.Random(seed), guard(damping_n_m_s_per_rad=1e-9, refill_w=0.0, count_rad=0.0)
    moved, forces, speed = [], [], 0.0
    for _ in range(5_000):
        speed = max(-40.0, min(40.0, speed + chance.uniform(-4.0, 4.0)))
        moved.append(speed / 1000.0)
        forces.append(stage.tick(moved[-1], -speed * 10.0))
        assert not stage.tripped
    assert 0.02 < energy_out(moved, forces) <= 0.045 + 1e-6
    free = [max(-0.5, min(0.5, -10.0 * 1000.0 * step)) for step in moved]
    assert energy_out(moved, free) > 1.0, "the hand gets far more without the guard"


def test_no_force_is_larger_than_the_motor_gives():
    assert [guard().tick(0.0, wanted) for wanted in (10.0, -10.0, 0.3)] == pytest.approx([0.5, -0.5, 0.3], abs=1e-7)
    assert guard().ticks(numpy.zeros(3), numpy.array([10.0, -10.0, math.inf])).tolist() == [0.5, -0.5, 0.5]


def test_overspeed_stops_the_force_until_it_is_resumed():
    stage = guard()
    assert stage.tick(0.0, 0.3) == pytest.approx(0.3, abs=1e-6)
    assert (stage.tick(1.0, 0.3), stage.tripped) == (0.0, True)
    assert (stage.tick(0.0, 0.3), stage.tripped) == (0.0, True)
    account = stage.account_j
    stage.resume()
    assert (stage.tripped, stage.account_j) == (False, account)


@pytest.mark.parametrize(
    "make, says",
    [
        (lambda: guard(rate_hz=0), "timing.rate_hz = 0 is outside 1 to 100000"),
        (lambda: guard(share_of_damping=1.5), "share_of_damping = 1.5 is outside 0 to 1"),
        (lambda: guard(count_rad=math.nan), "count_rad = NaN"),
        (lambda: guard(force_limit_n_m=math.inf), "force_limit_n_m = inf"),
        (lambda: guard().tick(math.nan, 0.0), "not a number"),
        (lambda: guard().ticks(numpy.zeros(3), numpy.zeros(2)), "3 displacements and 2 forces"),
        (lambda: guard(change_is_measured=True).tick(0.0, 0.1), "before_change_rad is missing"),
        (lambda: guard(change_is_measured=True).ticks(numpy.zeros(3), numpy.zeros(3)), "ticks takes no before_change_rad"),
        (lambda: guard().tick(0.0, 0.1, 0.0), "before_change_rad = 0, but the guard does not use it"),
        (lambda: touchstone.Wall({"law.guard.change": "measured"}), "law.guard.change = measured"),
        (lambda: touchstone.Wall({"law.kindd": "tdpa"}), "law.kindd: no such setting"),
        (lambda: touchstone.Wall({"law.kind": "TDPA"}), "law.kind = TDPA"),
        (lambda: touchstone.Wall({"law.energy_credit_j": -1.0}), "energy_credit_j = -1"),
        (lambda: touchstone.Wall(counts_per_rev=0), "counts_per_rev = 0"),
        (lambda: touchstone.Wall(preset="best"), 'preset = "best"'),
        (lambda: touchstone.Wall().tick(math.nan), "not a number"),
    ],
)
def test_a_mistake_is_named(make, says):
    with pytest.raises(ValueError, match=None) as error:
        make()
    assert says in str(error.value)


def test_hostile_calls_end_in_a_force_or_a_named_mistake():
    chance = random.Random(7)
    odd = [0.0, -0.0, 1e-300, 1e300, -1e300, math.inf, -math.inf, math.nan, 127.9, -128.0, 1e-7]
    stage, wall = guard(change_is_measured=True), touchstone.Wall()
    for _ in range(100_000):
        pick = lambda: chance.choice(odd) if chance.random() < 0.2 else chance.gauss(0.0, 0.05)
        call = chance.choice([lambda: stage.tick(pick(), pick(), pick()), lambda: wall.tick(pick()), lambda: stage.commanded(pick())])
        try:
            force = call()
        except ValueError as error:
            assert "not a number" in str(error)
        else:
            assert force is None or abs(force) <= 128.0
        if stage.tripped:
            stage.resume()
        if wall.tripped:
            wall.resume()
