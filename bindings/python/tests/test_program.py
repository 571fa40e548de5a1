"""Tests the Python functions that run the simulator. Skipped if the program is missing."""

import concurrent.futures

import numpy
import pytest
import touchstone

try:
    touchstone.program()
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)


def test_a_scene_gives_its_measures_and_its_trace():
    done = touchstone.run("tap", trace=True)
    assert done.verdict == done.summary["verdict"] != "no-contact"
    trace = done.trace()
    assert len(trace["time_s"]) == done.summary["ticks"]
    assert trace["force_n_m"].max() == done.summary["force_max"]


def test_a_changed_field_is_a_changed_run():
    heavy = touchstone.run("tap", {"device.inertia_kg_m2": 4e-4})
    assert heavy.summary != touchstone.run("tap").summary
    with pytest.raises(touchstone.Failed, match="trace=True"):
        heavy.trace()


def test_numbers_of_numpy_stay_whole_numbers_and_truth_values():
    plain = touchstone.run("tap", {"timing.rate_hz": 2000, "law.guard.on": True}).summary
    assert touchstone.run("tap", {"timing.rate_hz": numpy.int64(2000), "law.guard.on": numpy.bool_(True)}).summary == plain
    scene = {"timing": {"rate_hz": numpy.int64(2000)}, "wall": {"k_desired_n_m_per_rad": numpy.float32(5)}}
    assert touchstone.run(scene).summary["ticks"] > 0


def test_a_mistake_names_place_problem_and_remedy():
    with pytest.raises(touchstone.Mistake, match="did you mean kind"):
        touchstone.run("tap", {"law.kindd": 1})
    with pytest.raises(ValueError, match="no such scene"):
        touchstone.run("nosuch")


def test_a_demand_that_does_not_hold_is_an_error_with_results():
    with pytest.raises(touchstone.NotMet, match="required at most") as error:
        touchstone.run("tap", max_penetration=1e-4)
    assert error.value.code == 3
    assert error.value.results["runs"]


def test_a_dict_is_a_scene(tmp_path):
    file = tmp_path / "mine.toml"
    file.write_text("[device]\ninertia_kg_m2 = 0.0002\n", encoding="utf-8")
    from_file = touchstone.run(file)
    from_dict = touchstone.run({"device": {"inertia_kg_m2": 2e-4}})
    differ = {"scene"}
    assert {k: v for k, v in from_file.summary.items() if k not in differ} == {
        k: v for k, v in from_dict.summary.items() if k not in differ
    }


def test_runs_side_by_side_are_those_one_by_one():
    stiffness = [1, 2, 5, 10]
    ask = lambda k: touchstone.run("tap", k_desired=k).summary
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        assert list(pool.map(ask, stiffness)) == [ask(k) for k in stiffness]


def test_the_certificate_and_the_scenes_are_there():
    assert touchstone.certify("low-stiffness")
    assert touchstone.scenes()
