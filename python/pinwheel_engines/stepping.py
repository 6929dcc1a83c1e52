"""Fixed steps that hit every sample: an integer number of steps a sample, each of the wanted size or a little less."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

# Distance, in steps, within which two times are the same.
SAME = 1e-9


def steps_between(start_s: float, end_s: float, wanted_s: float) -> tuple[int, float]:
    """Number and size of equal steps from `start_s` to `end_s`, none longer than `wanted_s` (but for rounding)."""
    span = end_s - start_s
    count = max(1, math.ceil(span / wanted_s * (1.0 - 1e-9)))
    return count, span / count


@dataclass(frozen=True)
class Stretch:
    """A run of equal steps: `samples` intervals of `steps_a_sample` steps each.

    One that ends at a break of the load between samples is a single interval with no sample at its end.
    """

    start_s: float
    end_s: float
    samples: int
    steps_a_sample: int
    sampled: bool = True

    @property
    def steps(self) -> int:
        """All steps of the stretch."""
        return self.samples * self.steps_a_sample


def stretches(times_s: npt.NDArray[np.float64], wanted_s: float, breaks_s: Sequence[float] = ()) -> list[Stretch]:
    """Divides the sample grid into runs of equal steps: all full intervals, then the shorter last one if there is one.

    Every break of the load ends a run: a step has the load of one side. Where a break lies between two samples, the
    steps on both its sides are a little shorter.
    """
    if times_s.size < 2:
        return []
    parts: list[Stretch] = []
    first = 0
    for k in range(times_s.size - 1):
        pieces = legs(float(times_s[k]), float(times_s[k + 1]), breaks_s, wanted_s)
        if len(pieces) > 1:
            parts += _equal(times_s[first : k + 1], wanted_s)
            last = pieces[-1]
            parts += [Stretch(*leg, 1, steps_between(*leg, wanted_s)[0], sampled=leg == last) for leg in pieces]
            first = k + 1
        elif any(abs(break_s - times_s[k + 1]) <= SAME * wanted_s for break_s in breaks_s):
            parts += _equal(times_s[first : k + 2], wanted_s)
            first = k + 1
    return parts + _equal(times_s[first:], wanted_s)


def legs(start_s: float, end_s: float, breaks_s: Sequence[float], wanted_s: float) -> list[tuple[float, float]]:
    """The interval between two samples, cut at the breaks that lie inside it."""
    same = SAME * wanted_s
    cuts = [start_s, *(t for t in breaks_s if start_s + same < t < end_s - same), end_s]
    return list(itertools.pairwise(cuts))


def _equal(times_s: npt.NDArray[np.float64], wanted_s: float) -> list[Stretch]:
    """Stretches of a grid without breaks."""
    if times_s.size < 2:
        return []
    spans = np.diff(times_s)
    full = times_s.size - 1
    if spans.size > 1 and spans[-1] < spans[0] * (1.0 - 1e-9):
        full -= 1
    parts = []
    for first, last in ((0, full), (full, times_s.size - 1)):
        if last > first:
            count, _ = steps_between(float(times_s[first]), float(times_s[first + 1]), wanted_s)
            parts.append(Stretch(float(times_s[first]), float(times_s[last]), last - first, count))
    return parts


def actual_step_s(times_s: npt.NDArray[np.float64], wanted_s: float) -> float:
    """Step over the full sample intervals, s; the wanted one for a run without any."""
    parts = stretches(times_s, wanted_s)
    return (parts[0].end_s - parts[0].start_s) / parts[0].steps if parts else wanted_s
