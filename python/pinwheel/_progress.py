"""Progress of long work: tqdm where it is installed, nothing otherwise."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Progress = Callable[[int, int, str, float, float], object]


@contextmanager
def reporting(progress: bool | Progress | None, what: str) -> Iterator[Progress | None]:
    """Gives the function that is called with `(done, total, piece, simulated_s, of_s)`, or None without progress.

    `progress`: a function of your own; True for a bar, False for none; None for a bar on a terminal or in a notebook.
    """
    if callable(progress):
        yield progress
        return
    bar = _bar(what) if progress or (progress is None and _seen()) else None
    if bar is None:
        yield None
        return

    def report(done: int, total: int, piece: str, simulated_s: float, of_s: float) -> None:
        part = min(simulated_s / of_s, 1.0) if of_s > 0.0 and done < total else 0.0
        bar.total = float(total)
        # Pieces run in parallel and each begins at 0: the bar never goes back.
        bar.n = max(bar.n, min(done + part, float(total)))
        bar.set_postfix_str(f"{done}/{total} {piece}"[:40], refresh=False)
        bar.refresh()

    try:
        yield report
    finally:
        bar.close()


def _seen() -> bool:
    return sys.stderr.isatty() or "ipykernel" in sys.modules


def _bar(what: str) -> Any:
    try:
        # Without ipywidgets tqdm warns and draws no bar of a notebook's.
        if importlib.util.find_spec("ipywidgets"):
            from tqdm.auto import tqdm
        else:
            from tqdm import tqdm
    except ImportError:
        return None
    shape = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining} {postfix}"
    return tqdm(total=1.0, desc=what, leave=False, bar_format=shape)
