"""Results as pandas dataframes. Every column with a unit has it at the end of its name."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any, Mapping, Sequence

from ._errors import Failed

#: The end of a column's name, by the unit in the program's results.
ENDINGS = {
    "1": "",
    "1/rev": "_per_rev",
    "Hz": "_hz",
    "J": "_j",
    "N": "_n",
    "N/m": "_n_per_m",
    "N·m": "_n_m",
    "N·m/rad": "_n_m_per_rad",
    "m": "_m",
    "m/s": "_m_per_s",
    "rad": "_rad",
    "rad/s": "_rad_per_s",
    "s": "_s",
}


def pandas() -> Any:
    """The module pandas, which only dataframes need."""
    try:
        return importlib.import_module("pandas")
    except ImportError as missing:
        raise Failed("pandas is missing: pip install touchstone-haptics[frames]", 1) from missing


def column(name: str, unit: str) -> str:
    """The name of a measure's column: ``k_displayed`` in N·m/rad becomes ``k_displayed_n_m_per_rad``, as in the tables of a sweep."""
    ending = ENDINGS.get(unit, f" [{unit}]")
    return name if name.endswith(ending) else name + ending


def of_runs(runs: Sequence[Mapping[str, Any]], units: Mapping[str, str]) -> Any:
    """One row for each run, one column for each number or word. A measure that does not apply is NaN."""
    rows = [
        {column(name, units.get(name, "1")): value for name, value in run.items() if not isinstance(value, (list, dict))} for run in runs
    ]
    frame = pandas().DataFrame(rows)
    numbers = [name for name in map(lambda it: column(*it), units.items()) if name in frame.columns]
    return frame.astype({name: float for name in numbers})


def of_csv(file: Path) -> Any:
    """A table of the program, with every bit of its numbers."""
    library = pandas()
    # By default, pandas before version 3 may miss the last bit; later versions warn of the option.
    exact = {"float_precision": "round_trip"} if int(library.__version__.split(".")[0]) < 3 else {}
    return library.read_csv(file, **exact)
