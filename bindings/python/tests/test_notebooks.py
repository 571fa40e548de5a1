"""Runs the notebooks from the first cell to the last. Skipped without nbclient, ipykernel or the program."""

from pathlib import Path

import pytest
import touchstone

nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
import nbformat  # noqa: E402

try:
    touchstone.program()
except touchstone.Failed as missing:
    pytest.skip(str(missing), allow_module_level=True)

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))


def test_there_are_three():
    assert [file.stem for file in NOTEBOOKS] == ["first_wall", "tune_your_device", "what_the_guard_does"]


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_it_is_short_and_kept_without_outputs(file):
    book = nbformat.read(file, as_version=4)
    nbformat.validate(book)
    assert len(book.cells) <= 8
    assert all(not cell.outputs and cell.execution_count is None for cell in book.cells if cell.cell_type == "code")


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_it_runs_and_draws(file, tmp_path):
    book = nbformat.read(file, as_version=4)
    nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in book.cells if cell.cell_type == "code" for output in cell.outputs]
    drawn = [output.data["image/svg+xml"] for output in outputs if output.get("data", {}).get("image/svg+xml")]
    assert len(drawn) == 1
    assert "<svg" in drawn[0] and ("<polyline" in drawn[0] or "<path" in drawn[0])
    said = "".join(output.text for output in outputs if output.output_type == "stream" and output.name == "stderr")
    assert not said
