"""Tests ``touchstone export-fmu`` of the installed program with FMPy. Skipped without fmpy."""

import json
import runpy
import subprocess
from pathlib import Path

import pytest
import touchstone

fmpy = pytest.importorskip("fmpy")
COUPLE = Path(__file__).parents[2] / "fmi" / "examples" / "couple.py"


def test_the_fmus_of_the_installed_program_give_the_numbers_of_its_run(tmp_path):
    from fmpy.validation import validate_fmu

    words = [touchstone.program(), "export-fmu", "press-hold", "--out", str(tmp_path), "--json"]
    made = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
    files = [part["file"] for part in made["fmus"]]
    assert [validate_fmu(file) for file in files] == [[], []]
    example = runpy.run_path(str(COUPLE))
    law, plant = (example["Part"](file) for file in files)
    rows = list(example["run"](law, plant))
    law.close()
    plant.close()
    trace = touchstone.run("press-hold", trace=True).trace()
    assert len(rows) == len(trace["angle_rad"]) > 1000
    assert [row[1] for row in rows] == trace["angle_rad"].tolist()
    assert [-row[2] for row in rows] == trace["force_n_m"].tolist()
