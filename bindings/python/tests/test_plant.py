"""Tests the halves of scenes step by step: with both in a loop they give the numbers of ``touchstone run`` to the last bit."""

import math
import random

import numpy
import pytest
import touchstone

try:
    ALL = [scene["name"] for scene in touchstone.scenes()["scenes"]]
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)

SPACE = ["delta-ball"]


@pytest.mark.parametrize("scene", [name for name in ALL if name not in SPACE])
def test_plant_and_law_step_by_step_give_the_bits_of_the_run(scene):
    trace = touchstone.run(scene, trace=True).trace()
    plant, law = touchstone.Plant(scene), touchstone.Law(scene)
    assert plant.scene_steps == len(trace["angle_rad"])
    told = {name: [] for name in ("angle_rad", "velocity_rad_per_s", "penetration_told_rad", "hand_rad")}
    absorbed = []
    for _ in range(plant.scene_steps):
        told["angle_rad"].append(plant.angle_rad)
        told["velocity_rad_per_s"].append(plant.velocity_rad_per_s)
        told["hand_rad"].append(plant.hand_rad)
        before = plant.absorbed_j
        plant.step(law.tick(plant.angle_rad, plant.changed_at_rad))
        told["penetration_told_rad"].append(law.penetration_rad)
        absorbed.append(plant.absorbed_j - before)
    compared = [name for name in told if name in trace]
    assert {"angle_rad", "velocity_rad_per_s"} <= set(compared)
    for name in compared:
        assert numpy.array(told[name]).tobytes() == trace[name].tobytes(), name


def test_changes_are_those_of_a_run():
    changes = {"wall.k_desired_n_m_per_rad": 3.0, "device.inertia_kg_m2": 2e-4}
    trace = touchstone.run("tap", changes, trace=True).trace()
    plant, law = touchstone.Plant("tap", changes), touchstone.Law("tap", changes)
    angles = [plant.angle_rad]
    for _ in range(plant.scene_steps - 1):
        angles.append(plant.step(law.tick(plant.angle_rad, plant.changed_at_rad)))
    assert angles == trace["angle_rad"].tolist()
    assert angles != touchstone.run("tap", trace=True).trace()["angle_rad"].tolist()


def test_an_array_gives_the_bits_of_single_steps_and_reset_starts_anew():
    one, many = touchstone.Plant("press-hold"), touchstone.Plant("press-hold")
    torques = numpy.random.default_rng(1).normal(0.0, 0.02, 500)
    angles = many.steps(torques)
    assert [one.step(torque) for torque in torques] == angles.tolist()
    assert one.absorbed_j == many.absorbed_j
    assert one.time_s == pytest.approx(500 * one.period_s)
    many.reset()
    assert (many.time_s, many.absorbed_j) == (0.0, 0.0)
    assert many.steps(torques).tolist() == angles.tolist()


def test_a_scene_as_a_dict_and_a_moved_hand():
    scene = {"device": {"inertia_kg_m2": 2e-4}, "timing": {"duration_s": 0.2}}
    assert touchstone.Plant(scene).scene_steps == 200
    plant, other = touchstone.Plant("press-hold"), touchstone.Plant("press-hold")
    for _ in range(100):
        plant.step(0.0)
        other.step(0.0, hand_offset_rad=0.1)
    assert other.angle_rad > plant.angle_rad + 0.01


def test_a_guard_that_measures_the_change_of_torque_gets_its_angle():
    measured = {"law.guard.change": "measured", "law.guard.delay_s": 1e-4}
    late = {**measured, "timing.computational_delay_s": 1e-4}
    plant, law = touchstone.Plant("tap", late), touchstone.Law("tap", late)
    plant.step(law.tick(plant.angle_rad))
    with pytest.raises(ValueError, match="changed_at_rad is missing"):
        law.tick(plant.angle_rad)
    assert math.isfinite(law.tick(plant.angle_rad, plant.changed_at_rad))
    # Without a delay the torque changes at the sample, and the plant tells no other angle.
    plant, law = touchstone.Plant("tap", measured), touchstone.Law("tap", measured)
    for _ in range(3):
        plant.step(law.tick(plant.angle_rad, plant.changed_at_rad))


@pytest.mark.parametrize("half", [touchstone.Plant, touchstone.Law])
def test_a_wrong_scene_is_named(half):
    with pytest.raises(touchstone.Mistake, match="no such scene or file"):
        half("nosuch")
    with pytest.raises(touchstone.Mistake, match="device.inertia_kg_m2"):
        half("tap", {"device.inertia_kg_m2": -1.0})
    with pytest.raises(touchstone.Mistake, match="nosuch"):
        half("tap", {"nosuch.field": 1.0})


def test_hostile_steps_end_in_a_number_or_a_named_mistake():
    chance = random.Random(3)
    odd = [0.0, -0.0, 1e-300, 1e300, 1e6, -1e6, math.inf, -math.inf, math.nan]
    plant, law = touchstone.Plant("tap"), touchstone.Law("tap")
    for _ in range(20_000):
        pick = lambda: chance.choice(odd) if chance.random() < 0.1 else chance.gauss(0.0, 0.1)
        try:
            assert math.isfinite(law.tick(pick(), chance.choice([None, pick()])))
            assert math.isfinite(plant.step(pick(), pick()))
        except ValueError as error:
            assert "give a" in str(error)
        except OverflowError as error:
            assert "call reset()" in str(error)
            plant.reset()


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@pytest.mark.parametrize("scene", ["delta-ball", {"dof": 3, "law": {"approach": "shipped"}, "object": {"kind": "sphere"}}])
def test_three_axes_step_by_step_give_the_bits_of_the_run(scene):
    plant, wall = touchstone.SpacePlant(scene), touchstone.SpaceWall(scene)
    phases, places, forces = [], [], []
    for _ in range(plant.scene_steps):
        phases.append(plant.phase)
        places.append([1e3 * x for x in plant.position_m.tolist()])
        forces.append(plant.step(wall.tick(plant.measured_m)).tolist())
    results = touchstone.run(scene)["runs"][0]
    numbers = {**results, **results.get("numbers", {})}
    # The stiffness at rest in the last quarter of the hold, with the program's calculation in the program's order of operations.
    hold = [tick for tick, phase in enumerate(phases) if phase == "hold"]
    late = hold[len(hold) - int(len(hold) * 0.25) :]
    force = depth = 0.0
    for tick in late:
        place = places[tick]
        length = math.sqrt(dot(place, place))
        normal = [x / length for x in place]
        force += dot(normal, forces[tick])
        depth += 30.0 - length
    assert (force / len(late)) / (depth / len(late)) == numbers["displayed_at_rest_n_per_mm"]


def test_a_scene_of_one_axis_is_no_scene_of_three():
    with pytest.raises(touchstone.Mistake, match="dof"):
        touchstone.SpacePlant({"device": {"inertia_kg_m2": 1e-4}})
    with pytest.raises(ValueError, match="three"):
        touchstone.SpaceWall("tap")
    with pytest.raises(touchstone.Mistake, match="dof"):
        touchstone.SpaceWall({"dof": 2})


def space_guard(**changes):
    settings = dict(rate_hz=1000, force_limit_n=12.0, count_m=1e-5, damping_n_s_per_m=2.5, delay_s=0.0)
    return touchstone.SpaceGuard(**{**settings, **changes})


def test_a_guard_on_three_axes_bounds_what_a_hostile_force_gives():
    chance = numpy.random.default_rng(5)
    guard = space_guard(damping_n_s_per_m=1e-6, refill_w=0.0, count_m=0.0)
    place, force, speed, total, worst = numpy.zeros(3), numpy.zeros(3), numpy.zeros(3), 0.0, 0.0
    for _ in range(5000):
        speed = numpy.clip(speed + chance.normal(0.0, 0.05, 3), -0.5, 0.5)
        # Turns back beyond 80 mm, as a hand does.
        speed[abs(place) > 0.08] *= -numpy.sign(place * speed)[abs(place) > 0.08]
        total = max(0.0, total + float(force @ (speed * 1e-3)))
        worst = max(worst, total)
        place = place + speed * 1e-3
        force = guard.tick(place, 12.0 * speed / max(1e-9, numpy.linalg.norm(speed)))
        assert not guard.tripped
    assert 0.02 < worst <= 0.04 + 1e-5


def test_rows_give_the_bits_of_single_ticks():
    chance = numpy.random.default_rng(2)
    places = numpy.cumsum(chance.normal(0.0, 2e-4, (3000, 3)), axis=0)
    wanted = chance.normal(0.0, 8.0, (3000, 3))
    one, many = space_guard(), space_guard()
    rows = many.ticks(places, wanted)
    assert rows.shape == (3000, 3)
    assert [one.tick(*pair).tolist() for pair in zip(places, wanted)] == rows.tolist()
    assert one.account_j == many.account_j
    assert numpy.linalg.norm(rows, axis=1).max() <= 12.0 + 1e-6
    assert many.ticks(numpy.zeros((0, 3)), numpy.zeros((0, 3))).shape == (0, 3)


def test_overspeed_and_a_switched_off_motor_on_three_axes():
    guard = space_guard()
    still = numpy.zeros(3)
    wanted = numpy.array([0.0, 3.0, 4.0])
    assert guard.tick(still, wanted) == pytest.approx(wanted, abs=1e-6)
    assert not guard.tick(numpy.array([0.01, 0.0, 0.0]), wanted).any() and guard.tripped
    assert not guard.tick(numpy.array([0.01, 0.0, 0.0]), wanted).any()
    guard.resume()
    assert not guard.tripped
    guard = space_guard(refill_w=0.0)
    guard.tick(still, wanted)
    guard.switched_off()
    guard.resume()
    assert guard.account_j <= 0.0
    assert not guard.tick(still, wanted).any()


@pytest.mark.parametrize(
    "call, says",
    [
        (lambda: space_guard(rate_hz=0), "rate_hz = 0"),
        (lambda: space_guard(count_m=math.nan), "count_m = NaN"),
        (lambda: space_guard(force_limit_n=math.inf), "force_limit_n = inf"),
        (lambda: space_guard().tick(numpy.zeros(2), numpy.zeros(3)), "position_m has 2 numbers"),
        (lambda: space_guard().tick(numpy.zeros(3), numpy.array([0.0, math.nan, 0.0])), "wanted_n = NaN"),
        (lambda: space_guard().ticks(numpy.zeros((2, 3)), numpy.zeros((3, 3))), "2 positions and 3 forces"),
        (lambda: space_guard().ticks(numpy.zeros((2, 2)), numpy.zeros((2, 3))), "position_m has the shape [2, 2]"),
        (lambda: touchstone.SpaceWall().tick(numpy.zeros(4)), "measured_m has 4 numbers"),
        (lambda: touchstone.SpacePlant().step(numpy.array([math.inf, 0.0, 0.0])), "force_n = inf"),
    ],
)
def test_a_mistake_on_three_axes_is_named(call, says):
    with pytest.raises(ValueError) as error:
        call()
    assert says in str(error.value)
