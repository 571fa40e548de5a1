"""Computes tasks on any executor, and computes those again whose worker was killed."""

from __future__ import annotations

from concurrent.futures import BrokenExecutor, as_completed
from typing import Any, Callable, Sequence

from ._errors import Failed

#: Number of attempts to compute a task whose worker process or program was killed.
ATTEMPTS = 3


def compute(
    executor: Any,
    function: Callable[..., Any],
    missing: Callable[[], Sequence[int]],
    arguments: Callable[[int], tuple[Any, ...]],
    keep: Callable[[int, Any], object],
    said: Callable[[], str],
) -> None:
    """Calls ``function(*arguments(task))`` on the executor for every task that is ``missing``, and gives its result to ``keep``.

    ``executor`` is an executor of ``concurrent.futures``, a Dask ``Client`` or its executor, or a function that makes an executor. The function is
    called again after a worker was killed. ``said`` describes what is done, for the error after the last attempt.
    """
    makes = callable(executor) and not hasattr(executor, "submit")
    for attempt in range(ATTEMPTS):
        tasks = missing()
        if not tasks:
            return
        made = executor() if makes else executor
        # Dask's client has futures of its own type; its executor has those of the standard library.
        pool = made.get_executor() if hasattr(made, "get_executor") else made
        futures: dict[Any, int] = {}
        try:
            futures = {pool.submit(function, *arguments(task)): task for task in tasks}
            for future in as_completed(futures):
                keep(futures[future], future.result())
            return
        except Exception as broken:
            # Dask's error after it lost several workers has a class of its own.
            if not isinstance(broken, BrokenExecutor) and type(broken).__name__ != "KilledWorker":
                raise
            if not makes or attempt + 1 == ATTEMPTS:
                raise Failed(f"a worker of the executor was killed: {said()}; call again with a new executor, or give a function that makes one", 1) from broken
        finally:
            if makes:
                # Dask's executor cannot cancel them by itself.
                for future in futures:
                    future.cancel()
                pool.shutdown(wait=True)
                if made is not pool:
                    made.close()
