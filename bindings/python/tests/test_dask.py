"""Tests sweeps on a Dask ``LocalCluster`` of processes. Skipped without dask's ``distributed`` or the program.

The large map has 10,000 cells; the variable TOUCHSTONE_CELLS gives another number: ``TOUCHSTONE_CELLS=1000000 pytest tests/test_dask.py -k large``.
"""

import functools
import math
import os
import signal
from pathlib import Path

import pytest
import touchstone
from touchstone import _sweep

distributed = pytest.importorskip("distributed")

try:
    touchstone.program()
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)

CELLS = int(os.environ.get("TOUCHSTONE_CELLS", "10000"))
SHORT = {"timing.duration_s": 0.4}


def _map(out, side, **options):
    axes = (f"wall.k_desired_n_m_per_rad=1..20:{side}", f"device.inertia_kg_m2=5e-5..2e-4:{side}")
    return touchstone.sweep("tap", *axes, out=out, changes=SHORT, measure="penetration_max", no_certificate=True, **options)


def _same(one, other):
    one, other = ({file.name: file.read_bytes() for file in folder.iterdir()} for folder in (one, other))
    assert one.keys() == other.keys()
    # `results.json` contains the command, which differs.
    assert [name for name in one if one[name] != other[name]] in ([], ["results.json"])


@pytest.fixture(scope="module")
def client():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            yield client


def test_a_large_map_on_processes_has_the_bytes_of_one_process(client, tmp_path):
    side = math.isqrt(CELLS)
    seen = []
    _map(tmp_path / "cluster", side, executor=client, progress=lambda done, of: seen.append((done, of)))
    assert seen == [(done, 16) for done in range(1, 17)]
    results = _map(tmp_path / "alone", side, threads=1)
    assert results["cells"] == side * side
    _same(tmp_path / "alone", tmp_path / "cluster")


def _killed_once(flag, part, *words):
    """Computes a part of a sweep; at the first call, kills the worker process that runs it."""
    if not Path(flag).exists():
        Path(flag).write_text(str(os.getpid()))
        os.kill(os.getpid(), signal.SIGKILL)
    return part(*words)


def test_a_killed_worker_of_dask_costs_no_byte(client, tmp_path, monkeypatch):
    monkeypatch.setattr(_sweep, "_part", functools.partial(_killed_once, str(tmp_path / "killed"), _sweep._part))
    _map(tmp_path / "cluster", 6, executor=client, parts=6)
    killed = int((tmp_path / "killed").read_text())
    assert killed not in client.run(os.getpid).values(), "the worker that was killed is another one now"
    monkeypatch.undo()
    _map(tmp_path / "alone", 6)
    _same(tmp_path / "alone", tmp_path / "cluster")
