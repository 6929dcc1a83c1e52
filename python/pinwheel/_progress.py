"""Progress of long work: tqdm where it is installed, nothing otherwise."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Told = Callable[[int, int, str, float, float], object]


@contextmanager
def telling(progress: bool | Told | None, what: str) -> Iterator[Told | None]:
    """The function that is told `(done, total, piece, simulated_s, of_s)`.

    `progress`: a function of your own; True for a bar, False for none; None for a bar where somebody sees it.
    """
    if callable(progress):
        yield progress
        return
    bar = _bar(what) if progress or (progress is None and _seen()) else None
    if bar is None:
        yield None
        return

    def told(done: int, total: int, piece: str, simulated_s: float, of_s: float) -> None:
        now, of = (simulated_s, of_s) if of_s > 0.0 else (float(done), float(total))
        bar.total = of
        bar.n = of if done == total else min(now, of)
        bar.set_postfix_str(f"{done}/{total} {piece}"[:40], refresh=False)
        bar.refresh()

    try:
        yield told
    finally:
        bar.close()


def _seen() -> bool:
    return sys.stderr.isatty() or "ipykernel" in sys.modules


def _bar(what: str) -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    shape = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining} {postfix}"
    return tqdm(total=1.0, desc=what, leave=False, bar_format=shape)
