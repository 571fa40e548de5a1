"""Tests campaigns: many calls on threads, processes or a Dask cluster. Skipped if the program is missing."""

import concurrent.futures
import functools
import multiprocessing
import os
import signal
import subprocess
import threading
from pathlib import Path

import pytest
import touchstone

try:
    touchstone.program()
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)

# A forked worker of a process with threads may hang.
SPAWNED = multiprocessing.get_context("spawn")
LAWS = ["spring", "spring-damper", "tdpa"]
CARDS = [{"scene": "low-stiffness", "law": law} for law in LAWS]


@pytest.fixture(scope="module")
def one_by_one():
    return [touchstone.scorecard(**call) for call in CARDS]


def test_scorecards_on_processes_are_those_one_by_one(one_by_one):
    seen = []
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=SPAWNED) as pool:
        cards = touchstone.campaign(touchstone.scorecard, CARDS, executor=pool, progress=lambda done, of: seen.append((done, of)))
    assert cards == one_by_one
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_scorecards_on_a_cluster_of_dask_are_those_one_by_one(one_by_one):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            # A client, a function that makes an executor, and one that makes a client.
            for executor in [client, lambda: client.get_executor(), lambda: distributed.Client(cluster)]:
                assert touchstone.campaign(touchstone.scorecard, CARDS, executor=executor) == one_by_one


def _killed_once(flag, **call):
    """Makes a scorecard; at the first call, kills the worker process that runs it."""
    if not Path(flag).exists():
        Path(flag).write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    return touchstone.scorecard(**call)


def test_a_killed_worker_costs_no_scorecard(one_by_one, tmp_path):
    make = lambda: concurrent.futures.ProcessPoolExecutor(1, mp_context=SPAWNED)
    function = functools.partial(_killed_once, str(tmp_path / "killed"))
    assert touchstone.campaign(function, CARDS, executor=make) == one_by_one
    assert (tmp_path / "killed").exists()


@pytest.mark.parametrize("workers", [None, 2])
def test_a_scene_file_goes_to_the_worker(tmp_path, workers):
    file = tmp_path / "mine.toml"
    file.write_text("[device]\ninertia_kg_m2 = 0.0002\n", encoding="utf-8")
    calls = [{"scene": file, "k_desired": k} for k in (1, 5)]
    alone = [touchstone.run(**call).summary for call in calls]
    if workers is None:
        assert [done.summary for done in touchstone.campaign(touchstone.run, calls)] == alone
        return
    with concurrent.futures.ProcessPoolExecutor(workers, mp_context=SPAWNED) as pool:
        done = touchstone.campaign(touchstone.run, calls, executor=pool)
    assert [one.summary for one in done] == alone


def test_a_mistake_comes_back_from_a_worker_process():
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=SPAWNED) as pool:
        with pytest.raises(touchstone.Mistake, match="nosuch") as error:
            touchstone.campaign(touchstone.run, [{"scene": "nosuch"}], executor=pool)
        assert error.value.code == 2
        with pytest.raises(touchstone.NotMet) as error:
            touchstone.campaign(touchstone.run, [{"scene": "tap", "max_penetration": 1e-4}], executor=pool)
        assert error.value.results["runs"]


def test_a_thousand_runs_use_all_cores(monkeypatch):
    """Counts the programs that run at once: as many as there are cores, and never more."""
    cores, lock = 4, threading.Lock()
    monkeypatch.setattr(os, "cpu_count", lambda: cores)
    running, most, real = 0, 0, subprocess.run

    def counted(*words, **options):
        nonlocal running, most
        with lock:
            running += 1
            most = max(most, running)
        try:
            return real(*words, **options)
        finally:
            with lock:
                running -= 1

    monkeypatch.setattr(subprocess, "run", counted)
    stiffness = [1 + 0.01 * n for n in range(1000)]
    calls = [{"scene": "tap", "k_desired": k, "changes": {"timing.duration_s": 0.4}} for k in stiffness]
    done = touchstone.campaign(touchstone.run, calls)
    assert [one.summary["k_desired"] for one in done] == pytest.approx(stiffness)
    assert most == cores
