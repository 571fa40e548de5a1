"""Tests the script of the GitHub action in bindings/ci, without running pip. Skipped if the program or bash is missing."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import touchstone

try:
    PROGRAM = Path(touchstone.program())
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)
if shutil.which("bash") is None:
    pytest.skip("no bash", allow_module_level=True)


def script():
    """Returns the action's shell script: the text below ``run: |`` in its YAML file."""
    text = (Path(__file__).parents[2] / "ci" / "action.yml").read_text(encoding="utf-8")
    return "".join(line[8:] + "\n" for line in text.split("      run: |\n")[1].splitlines())


@pytest.mark.parametrize("demands, code", [("--max-penetration 1", 0), ("--min-stiffness 0 --max-penetration 0.0001", 3), ("--nosuch", 2)])
def test_it_fails_where_the_wall_does_not_hold(tmp_path, demands, code):
    asked = tmp_path / "asked"
    python = tmp_path / "python3"
    python.write_text(f'#!/bin/sh\necho "$@" > "{asked}"\n')
    python.chmod(0o755)
    (tmp_path / "touchstone").symlink_to(PROGRAM)
    scene = subprocess.run([PROGRAM, "run", "thesis-knob", "--print"], capture_output=True, check=True).stdout
    (tmp_path / "my scene.toml").write_bytes(scene)
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    words = {"SCENE": "my scene.toml", "DEMANDS": demands, "PACKAGE": "a package", "REPORT": "report", "PATH": path}
    done = subprocess.run(["bash", "-c", script()], cwd=tmp_path, env={**os.environ, **words}, capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    assert asked.read_text().strip() == "-m pip install --quiet a package"
    assert (tmp_path / "report" / "summary.svg").exists() == (code != 2)
    assert (tmp_path / "report.xml").exists() == (code != 2)
