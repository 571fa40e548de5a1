"""Sweeps: simulates a scene for every pair of values of two settings. Threads, processes or a Dask cluster compute the parts of a sweep."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Callable, Sequence

from . import _executor, _frames
from ._errors import Failed
from ._program import Changes, Scene, _ask, _changes, _options, _Scene


class Sweep(dict[str, Any]):
    """The results of ``sweep``: a dict with the content of the program's ``results.json``. ``out`` is the folder with cells and maps."""

    def __init__(self, results: dict[str, Any], out: str | os.PathLike[str]) -> None:
        super().__init__(results)
        self.out = Path(out)

    def frame(self) -> Any:
        """The cells as a pandas dataframe: one row for each pair of values. Names of columns end with the unit: ``k_displayed_n_m_per_rad``."""
        return _frames.of_csv(self.out / "cells.csv")


def sweep(
    scene: Scene,
    x: str,
    y: str,
    *,
    out: str | os.PathLike[str],
    changes: Changes = None,
    measure: str | Sequence[str] = (),
    executor: Any = None,
    parts: int | None = None,
    progress: Callable[[int, int], object] | None = None,
    **options: Any,
) -> Sweep:
    """Simulates a scene once for every pair of values of two settings. Returns the results of ``touchstone sweep``, and writes files and maps to ``out``.

    ``x`` and ``y`` are axes in the program's format: ``"wall.k_desired_n_m_per_rad=0.5..10:100"``. ``executor`` computes the parts. It is any
    executor of ``concurrent.futures``, a Dask ``Client`` or its executor, or a function that makes an executor. The function is called again after
    a worker was killed. Without an executor, this machine's cores compute. The files are byte for byte the same for every executor and every
    number of ``parts``.

    ``progress(done, parts)`` is called after each part. Finished parts stay in ``out + ".parts"`` until the sweep is complete, so that the
    same call continues after an interruption. Another sweep needs another ``out``.

        >>> from distributed import Client
        >>> sweep("tap", "wall.k_desired_n_m_per_rad=1..20:1000", "timing.rate_hz=500..4000:1000", out="map", measure="k_displayed", executor=Client("host:8786"))
    """
    measures = [measure] if isinstance(measure, str) else list(measure)
    asked = [*_changes(changes), *_options({"x": x, "y": y, "measure": measures, **options})]
    if executor is None:
        with _Scene(scene) as name:
            return Sweep(_ask("sweep", name, *asked, "--out", os.fspath(out)), out)
    if not measures:
        # `sweep merge` cannot read parts without a measure.
        raise ValueError("measure = (): name at least one measure where an executor computes, such as \"penetration_max\"")
    text = _text_of(scene)
    count = parts or 16
    kept = Path(os.fspath(out) + ".parts")
    kept.mkdir(parents=True, exist_ok=True)
    folders = [kept / f"{count}-{part}" for part in range(1, count + 1)]

    def keep(part: int, files: dict[str, bytes]) -> None:
        _keep(folders[part], files)
        if progress:
            progress(done(), count)

    def done() -> int:
        return sum(folder.exists() for folder in folders)

    _executor.compute(
        executor,
        _part,
        lambda: [part for part, folder in enumerate(folders) if not folder.exists()],
        lambda part: (text, asked, part + 1, count),
        keep,
        lambda: f"{done()} of {count} parts of the sweep are done, and are kept",
    )
    drawn: dict[str, Any] = {name: options[name] for name in ("no_certificate", "overlay", "force") if name in options}
    results = _ask("sweep", "merge", *map(str, folders), *_options(drawn), "--out", os.fspath(out))
    for folder in folders:
        for file in folder.iterdir():
            file.unlink()
        folder.rmdir()
    if not any(kept.iterdir()):
        kept.rmdir()
    return Sweep(results, out)


def _part(text: str | bytes, asked: list[str], part: int, parts: int) -> dict[str, bytes]:
    """Computes one part of a sweep; runs on a worker of the executor. Returns the part's files by name."""
    with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
        if isinstance(text, str):
            scene = text
        else:
            scene = str(Path(folder) / "scene.toml")
            Path(scene).write_bytes(text)
        made = Path(folder) / "part"
        for attempt in range(_executor.ATTEMPTS):
            try:
                # One thread, because there are at least as many workers as cores.
                _ask("sweep", scene, *asked, "--threads", "1", "--shard", f"{part}/{parts}", "--out", str(made))
                break
            except Failed as failed:
                # An exit code below 0: a signal killed the program. Its folder keeps the finished runs.
                if failed.code >= 0 or attempt + 1 == _executor.ATTEMPTS:
                    raise
        return {file.name: file.read_bytes() for file in made.iterdir()}


def _keep(folder: Path, files: dict[str, bytes]) -> None:
    """Writes the files of a sweep's part. Their folder appears with all files or not at all."""
    written = Path(tempfile.mkdtemp(prefix="part-", dir=folder.parent))
    for name, content in files.items():
        (written / name).write_bytes(content)
    written.rename(folder)


def _text_of(scene: Scene) -> str | bytes:
    """The name of a shipped scene, or the content of a scene file, because a worker may run on another machine."""
    with _Scene(scene) as name:
        return Path(name).read_bytes() if Path(name).is_file() else name
