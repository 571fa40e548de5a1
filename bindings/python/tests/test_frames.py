"""Tests dataframes of runs and sweeps. Skipped without pandas or the program."""

import sys

import pytest
import touchstone

pandas = pytest.importorskip("pandas")

try:
    touchstone.program()
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)


def test_a_run_is_a_row_with_units_in_the_names():
    done = touchstone.run("press-hold")
    frame = done.frame()
    assert len(frame) == 1
    row = frame.iloc[0]
    assert row["verdict"] == done.verdict
    assert row["k_displayed_n_m_per_rad"] == done.summary["k_displayed"]
    assert row["rate_hz"] == done.summary["rate_hz"]
    assert row["energy_out_j"] == done.summary["energy_out"]
    assert row["force_max_n_m"] == done.summary["force_max"]
    assert row["penetration_max_rad"] == done.summary["penetration_max"]
    assert row["release_speed_rad_per_s"] == done.summary["release_speed_rad_per_s"]
    assert row["settle_time_s"] == done.summary["settle_time"]
    assert row["contact_ticks"] == done.summary["contact_ticks"]
    for name, unit in done["units"].items():
        assert unit in touchstone._frames.ENDINGS, f"{name}: the unit {unit} has no ending"
        assert touchstone._frames.column(name, unit) in frame.columns


def test_rows_of_several_runs_join():
    runs = [touchstone.run("tap", k_desired=k).frame() for k in (1, 5)]
    frame = pandas.concat(runs, ignore_index=True)
    assert frame["k_desired_n_m_per_rad"].tolist() == [1.0, 5.0]
    assert all(frame[name].dtype == float for name in frame.columns if name.endswith(("_j", "_rad", "_n_m", "_s")))


def test_a_run_of_three_axes_is_a_row():
    done = touchstone.run("delta-ball")
    (row,) = done.frame().to_dict("records")
    assert row["slide_mm_per_s"] == done.summary["slide_mm_per_s"]


def test_a_trace_is_a_row_for_each_period():
    done = touchstone.run("tap", trace=True)
    frame = done.trace_frame()
    assert len(frame) == done.summary["ticks"]
    assert frame["force_n_m"].max() == done.summary["force_max"]
    with pytest.raises(touchstone.Failed, match="trace=True"):
        touchstone.run("tap").trace_frame()


def test_a_sweep_is_a_row_for_each_cell(tmp_path):
    axes = ("wall.k_desired_n_m_per_rad=1,5", "device.inertia_kg_m2=1e-4,2e-4")
    frame = touchstone.sweep("tap", *axes, out=tmp_path / "map", measure="penetration_max", no_certificate=True).frame()
    assert len(frame) == 4
    for _, row in frame.iterrows():
        changes = {name: row[name] for name in ("wall.k_desired_n_m_per_rad", "device.inertia_kg_m2")}
        run = touchstone.run("tap", changes)
        assert row["penetration_max_rad"] == run.summary["penetration_max"]
        assert row["verdict"] == run.verdict


def test_without_pandas_the_error_names_the_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(touchstone.Failed, match=r"pip install touchstone-haptics\[frames\]"):
        touchstone.run("tap").frame()
