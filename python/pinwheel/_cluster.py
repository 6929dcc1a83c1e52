"""A sweep by the workers of a Dask cluster.

The client plans, keeps the journal and writes the results; workers get batches of runs, each with its complete scene, and
send records back. Time series, where they are kept, go from the worker to the journal's folder, which must be on a disk that
all machines share. Dask gives batches of a lost worker to others; nothing else is tried again.
"""

from __future__ import annotations

import pickle
import time
import uuid
from asyncio import CancelledError
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pinwheel import _core
from pinwheel._engine import Engine
from pinwheel._progress import Progress
from pinwheel.errors import ClusterError

if TYPE_CHECKING:
    from distributed import Client, Future

# Time of a batch, s: far more than the scheduler's milliseconds, and a small loss with a worker.
BATCH_S = 0.5
# Batches that wait for a thread beside the one in work: the thread never idles, and few are sent in vain.
AHEAD = 2
# Runs of the first batches, before the time of a run is known.
FIRST = 4
MOST = 256


def run_batch(batch: bytes) -> tuple[float, list[str]]:
    """Makes runs on a worker; returns wall time, s, and records."""
    tasks, engines, time_series = pickle.loads(batch)
    begun = time.perf_counter()
    records = _core.perform(tasks, engines, time_series)
    return time.perf_counter() - begun, records


def execute(client: Client, core: _core.Sweep, engines: Sequence[Engine], batch: int | None, show: Progress | None) -> None:
    """Makes every run that the journal lacks."""
    import cloudpickle
    from distributed import wait
    from distributed.comm import CommClosedError
    from distributed.scheduler import KilledWorker

    left = total = len(core)
    time_series = core.time_series()
    name = f"pinwheel-{uuid.uuid4().hex[:8]}"
    flying: dict[Future, list[int]] = {}
    size, count, done = batch or FIRST, 0, 0
    try:
        while left or flying:
            threads = max(1, sum(client.nthreads().values()))
            while left and len(flying) < AHEAD * threads:
                # Batches shrink at the end, so that all threads have work.
                share = max(1, left // (2 * threads)) if batch is None else size
                tasks, left = core.take(min(size, share))
                done = total - left - len(tasks) - sum(map(len, flying.values()))
                if not tasks:
                    break
                # One piece of bytes: Dask would look into lists for tasks of its own.
                data = cloudpickle.dumps((tasks, list(engines), time_series))
                future = client.submit(run_batch, data, key=f"{name}-{count}", pure=False, retries=0)
                flying[future] = [number for number, *_ in tasks]
                count += 1
            try:
                with client.as_current():
                    ready = wait(list(flying), timeout=0.2, return_when="FIRST_COMPLETED").done
            except TimeoutError:
                ready = {future for future in flying if future.status in ("cancelled", "lost")}
            if client.status not in ("running", "connecting"):
                raise CommClosedError("the client is closed")
            for future in ready:
                numbers = flying.pop(future)
                wall_s, records = future.result(timeout=30)
                for number, record in zip(numbers, records, strict=True):
                    core.accept(number, record)
                done += len(numbers)
                if batch is None and wall_s > 0.0:
                    size = max(1, min(MOST, 2 * size, round(BATCH_S * len(numbers) / wall_s)))
            if show is not None:
                show(done, total, core.name(), 0.0, 0.0)
    except KilledWorker as error:
        raise ClusterError(
            f"runs of one batch lost several workers one after the other: {error}; {_kept(done, total)}; give workers more "
            "memory, or smaller batches with batch=1"
        ) from error
    except (CancelledError, CommClosedError, TimeoutError, OSError) as error:
        raise ClusterError(f"the scheduler is gone ({_words(error)}); {_kept(done, total)}") from error
    except BaseException:
        client.cancel(list(flying), force=True)
        raise


def _kept(done: int, total: int) -> str:
    return f"{done} of {total} runs are kept: go on with resume=True"


def _words(error: BaseException) -> str:
    text: Any = " ".join(str(error).split())
    return f"{type(error).__name__}: {text[:200]}" if text else type(error).__name__
