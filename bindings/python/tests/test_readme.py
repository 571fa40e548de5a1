"""Runs what the README tells a reader to type. Skipped if the program is missing."""

import os
import re
import subprocess
from pathlib import Path

import pytest
import touchstone

try:
    PROGRAM = Path(touchstone.program())
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def _blocks(language):
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def test_three_commands_give_a_verdict_without_rust(tmp_path):
    install, *commands = _blocks("sh")[0].splitlines()
    # The tests run in an environment in which the package is already installed.
    assert install.startswith("pip install ")
    assert len(commands) == 2
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "touchstone").symlink_to(PROGRAM)
    empty = tmp_path / "empty"
    empty.mkdir()
    for command in commands:
        # The PATH has the program and nothing else.
        done = subprocess.run(command, shell=True, cwd=empty, env={"PATH": str(tmp_path / "bin")}, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert "passive" in done.stdout
    assert (empty / "report" / "summary.svg").exists()


def test_the_first_example_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(_blocks("python")[0], names)  # noqa: S102
    assert capsys.readouterr().out.startswith("passive ")
    assert names["allowed"] == pytest.approx(0.3, abs=1e-6)
    assert os.listdir(tmp_path) == []
