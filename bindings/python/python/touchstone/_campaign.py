"""Campaigns: many calls of one function, such as ``scorecard``, on the cores of this machine or of others."""

from __future__ import annotations

import concurrent.futures
import os
import tempfile
from pathlib import Path
from typing import Any, Callable, Mapping, Sequence

from . import _executor
from ._program import _Scene


def campaign(
    function: Callable[..., Any],
    calls: Sequence[Mapping[str, Any]],
    *,
    executor: Any = None,
    progress: Callable[[int, int], object] | None = None,
) -> list[Any]:
    """Calls ``run``, ``scorecard``, ``tune`` or ``certify`` once for each dict of keywords in ``calls``. Returns the results in the order of ``calls``.

    ``executor`` is as in ``sweep``; without it, this machine's cores compute. A call whose worker is killed is computed again. The results are those
    of the same calls one by one. ``progress(done, calls)`` is called after each call. The first call that raises an error ends the campaign.

        >>> laws = ["enhanced", "spring", "tdpa"]
        >>> campaign(scorecard, [{"scene": "thesis-knob", "law": law} for law in laws], executor=Client("host:8786"))

    An executor gets the content of a scene file, so that the worker may be another machine. Other paths in a call, such as ``settings=``, are
    those of the worker's machine.
    """
    # Without an executor all calls run on this machine, and each call reads its scene file itself.
    sent = [_sent(call) if executor else (dict(call), "", None) for call in calls]
    done: dict[int, Any] = {}

    def keep(index: int, result: Any) -> None:
        done[index] = result
        if progress:
            progress(len(done), len(sent))

    def threads() -> Any:
        # Each call waits for a process of its own, so that threads use all cores.
        return concurrent.futures.ThreadPoolExecutor(os.cpu_count())

    _executor.compute(
        executor or threads,
        _call,
        lambda: [index for index in range(len(sent)) if index not in done],
        lambda index: (function, *sent[index]),
        keep,
        lambda: f"{len(done)} of {len(sent)} calls were done",
    )
    return [done[index] for index in range(len(sent))]


def _sent(call: Mapping[str, Any]) -> tuple[dict[str, Any], str, bytes | None]:
    """A call's keywords, the name of its scene's file, and the file's content, because a worker may run on another machine."""
    keywords = dict(call)
    scene = keywords.get("scene", keywords.get("device"))
    if scene is None or isinstance(scene, Mapping):
        return keywords, "", None
    with _Scene(scene) as name:
        path = Path(name)
        return keywords, path.name, path.read_bytes() if path.is_file() else None


def _call(function: Callable[..., Any], keywords: dict[str, Any], name: str, content: bytes | None) -> Any:
    """Makes one call; runs on a worker of the executor."""
    if content is None:
        return function(**keywords)
    with tempfile.TemporaryDirectory(prefix="touchstone-") as folder:
        file = Path(folder) / name
        file.write_bytes(content)
        return function(**{**keywords, "device" if "device" in keywords else "scene": file})
