"""Tests sweeps over two settings whose parts run on executors. Skipped if the program is missing."""

import concurrent.futures
import functools
import multiprocessing
import os
import signal
from pathlib import Path

import pytest
import touchstone
from touchstone import _sweep

try:
    touchstone.program()
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)

AXES = ("wall.k_desired_n_m_per_rad=1..20:6", "device.inertia_kg_m2=5e-5..2e-4:5")
SHORT = {"timing.duration_s": 0.5}
# A forked worker of a process with threads may hang.
SPAWNED = multiprocessing.get_context("spawn")


def _map(out, axes=AXES, **options):
    return touchstone.sweep("tap", *axes, out=out, changes=SHORT, measure="k_displayed", no_certificate=True, **options)


def _files(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def _same(one, other):
    # `results.json` contains the command, which differs.
    one, other = _files(one), _files(other)
    assert one.keys() == other.keys()
    assert [name for name in one if one[name] != other[name]] in ([], ["results.json"])


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    out = tmp_path_factory.mktemp("whole") / "map"
    return _map(out), out


@pytest.mark.parametrize("parts", [1, 7])
def test_parts_on_threads_make_the_same_bytes(whole, tmp_path, parts):
    seen = []
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        results = _map(tmp_path / "map", executor=pool, parts=parts, progress=lambda done, of: seen.append((done, of)))
    assert results["verdicts"] == whole[0]["verdicts"]
    assert seen == [(done, parts) for done in range(1, parts + 1)]
    _same(whole[1], tmp_path / "map")
    assert not (tmp_path / "map.parts").exists()


def test_a_scene_as_a_dict_goes_to_the_workers(tmp_path):
    scene = {"device": {"inertia_kg_m2": 2e-4}, "timing": {"duration_s": 0.2}}
    axes = ("wall.k_desired_n_m_per_rad=1,2", "timing.rate_hz=1000,2000")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = touchstone.sweep(scene, *axes, out=tmp_path / "map", executor=pool, parts=2, measure="penetration_max", no_certificate=True)
    assert sum(results["verdicts"].values()) == 4


def _killed_once(flag, *words):
    """Computes a part of a sweep; at the first call, kills the worker process that runs it."""
    if not Path(flag).exists():
        Path(flag).write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    return _PART(*words)


_PART = _sweep._part


def test_a_killed_worker_costs_its_part_and_no_byte(whole, tmp_path, monkeypatch):
    monkeypatch.setattr(_sweep, "_part", functools.partial(_killed_once, str(tmp_path / "killed")))
    make = lambda: concurrent.futures.ProcessPoolExecutor(2, mp_context=SPAWNED)
    _map(tmp_path / "map", executor=make, parts=6)
    assert (tmp_path / "killed").exists()
    _same(whole[1], tmp_path / "map")


def test_an_executor_that_broke_names_the_remedy_and_keeps_what_is_done(whole, tmp_path, monkeypatch):
    monkeypatch.setattr(_sweep, "_part", functools.partial(_killed_once, str(tmp_path / "killed")))
    make = lambda: concurrent.futures.ProcessPoolExecutor(1, mp_context=SPAWNED)
    with make() as pool, pytest.raises(touchstone.Failed, match="call again with a new executor"):
        _map(tmp_path / "map", executor=pool, parts=3)
    with make() as pool:
        _map(tmp_path / "map", executor=pool, parts=3)
    _same(whole[1], tmp_path / "map")


def test_a_mistake_is_told_as_without_an_executor(tmp_path):
    with concurrent.futures.ThreadPoolExecutor(1) as pool, pytest.raises(touchstone.Mistake, match="nosuch"):
        _map(tmp_path / "map", axes=("nosuch.field=1..2:2", AXES[1]), executor=pool, parts=2)


def test_parts_without_a_measure_are_refused(tmp_path):
    with concurrent.futures.ThreadPoolExecutor(1) as pool, pytest.raises(ValueError, match="name at least one measure"):
        touchstone.sweep("tap", *AXES, out=tmp_path / "map", executor=pool)
