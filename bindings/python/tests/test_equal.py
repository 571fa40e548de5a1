"""Tests that the Python package and the program give the same numbers to the last bit for a shipped scene. Skipped if the program is missing."""

import json
import subprocess

import numpy
import pytest
import touchstone

try:
    ALL = [scene["name"] for scene in touchstone.scenes()["scenes"]]
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)


#: Scenes of three axes, which have results but no trace.
SPACE = ["delta-ball"]
SCENES = [name for name in ALL if name not in SPACE]


@pytest.mark.parametrize("scene", SPACE)
def test_three_axes_have_the_programs_results_and_no_trace(scene):
    printed = subprocess.run([touchstone.program(), "run", scene, "--json"], check=True, capture_output=True).stdout
    assert touchstone.run(scene)["runs"] == json.loads(printed)["runs"]
    with pytest.raises(touchstone.Mistake, match="without trace=True"):
        touchstone.run(scene, trace=True)


@pytest.fixture(scope="module", params=SCENES)
def both(request, tmp_path_factory):
    """Results of a scene from the Python package, and the output and files of the program for the same scene."""
    folder = tmp_path_factory.mktemp("run") / request.param
    words = [touchstone.program(), "run", request.param, "--json", "--out", str(folder)]
    printed = subprocess.run(words, check=True, capture_output=True).stdout
    return touchstone.run(request.param, trace=True), json.loads(printed), folder


def test_measures_are_the_programs(both):
    package, program, _ = both
    assert [package.summary] == program["runs"]


def test_traces_are_the_programs(both):
    package, _, folder = both
    (file,) = (folder / "traces").glob("*.csv")
    names, *rows = file.read_text(encoding="utf-8").splitlines()
    columns = zip(*(row.split(",") for row in rows))
    program = {name: numpy.array([float(it or "nan") for it in column]) for name, column in zip(names.split(","), columns)}
    package = package.trace()
    assert list(package) == list(program)
    for name, column in program.items():
        assert package[name].tobytes() == column.tobytes(), name


def _settings(table, prefix=""):
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _settings(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def test_a_wall_tick_by_tick_gives_the_forces_of_the_run(both):
    tomllib = pytest.importorskip("tomllib", reason="Python 3.11 reads TOML")
    package, _, folder = both
    scene = tomllib.loads((folder / "scene.toml").read_text(encoding="utf-8"))
    settings = {path: value for path, value in _settings(scene) if path.startswith("law.") and path != "law.number"}
    settings["timing.rate_hz"] = scene["timing"]["rate_hz"]
    if "encoder" not in scene:
        pytest.skip("no encoder: the law reads the exact position")
    settings["wall.k_desired_n_m_per_rad"] = scene["wall"]["k_desired_n_m_per_rad"]
    counts_per_rev, surface_rad = scene["encoder"]["counts_per_rev"], scene["wall"]["surface_rad"]
    wall = touchstone.Wall(settings, counts_per_rev=counts_per_rev, surface_rad=surface_rad)
    trace = package.trace()
    counts = numpy.rint(trace["angle_measured_rad"] * counts_per_rev / (2 * numpy.pi)).astype(int)
    assert [-wall.tick_count(count) for count in counts.tolist()] == trace["force_n_m"].tolist()
