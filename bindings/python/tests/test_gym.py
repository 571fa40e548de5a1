"""Tests the Gymnasium environments with a simulated knob. Skipped without gymnasium."""

import math
import warnings

import numpy
import pytest

gymnasium = pytest.importorskip("gymnasium")

import touchstone.gym  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402

NAMES = ["touchstone/Press-v0", "touchstone/FindDetent-v0", "touchstone/Hold-v0"]


@pytest.mark.parametrize("name", NAMES)
def test_the_checker_has_no_objection(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(name).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_gives_the_same_episode_and_another_one_another(name):
    def episode(seed):
        env = gymnasium.make(name)
        first, _ = env.reset(seed=seed)
        return numpy.array([first] + [env.step([math.sin(n)])[0] for n in range(50)])

    assert numpy.array_equal(episode(1), episode(1))
    assert not numpy.array_equal(episode(1), episode(2))


def _last(name, hand, seed):
    env = gymnasium.make(name)
    observation, _ = env.reset(seed=seed)
    terminated = truncated = False
    while not (terminated or truncated):
        observation, reward, terminated, truncated, info = env.step([hand(observation)])
    return reward, info, env.unwrapped


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_pushes_with_the_asked_torque_has_pressed(seed):
    damped = lambda seen: (seen[3] - 3e-3 * seen[1]) / touchstone.gym.HAND_TORQUE_N_M
    reward, info, _ = _last("touchstone/Press-v0", damped, seed)
    assert reward > 0.9, info
    assert _last("touchstone/Press-v0", lambda seen: 0.0, seed)[0] < 0.01


@pytest.mark.parametrize("seed", range(5))
def test_a_servo_holds_against_the_noise_and_a_limp_hand_does_not(seed):
    servo = lambda seen: (2.0 * (seen[3] - seen[0]) - 0.02 * seen[1]) / touchstone.gym.HAND_TORQUE_N_M
    held = _last("touchstone/Hold-v0", servo, seed)[1]["error"]
    limp = _last("touchstone/Hold-v0", lambda seen: 0.0, seed)[1]["error"]
    assert abs(held) < 1 < abs(limp)


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_in_the_deep_detent_has_found_it(seed):
    env = gymnasium.make("touchstone/FindDetent-v0").unwrapped
    env.reset(seed=seed)
    place = env._deep * env.WIDTH_RAD
    servo = lambda seen: (place - seen[0] - 0.02 * seen[1]) / touchstone.gym.HAND_TORQUE_N_M
    reward, info, _ = _last("touchstone/FindDetent-v0", servo, seed)
    assert reward > 0.9, info


def test_the_knob_turns_as_its_closed_form():
    knob, torque, ticks = touchstone.gym.Knob(), 0.01, 500
    for _ in range(ticks):
        knob.advance(torque)
    time, constant = ticks / touchstone.gym.RATE_HZ, touchstone.gym.INERTIA_KG_M2 / touchstone.gym.DAMPING_N_M_S_PER_RAD
    final = torque / touchstone.gym.DAMPING_N_M_S_PER_RAD
    assert knob.speed_rad_per_s == pytest.approx(final * (1 - math.exp(-time / constant)), rel=1e-12)
    assert knob.angle_rad == pytest.approx(final * (time - constant * (1 - math.exp(-time / constant))), rel=1e-12)


def test_an_action_that_is_no_number_is_refused():
    env = gymnasium.make("touchstone/Hold-v0").unwrapped
    env.reset(seed=1)
    with pytest.raises(ValueError, match="from -1 to 1"):
        env.step([math.nan])
