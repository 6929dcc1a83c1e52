"""Fixed steps that hit every sample: the step is the wanted one or a little less, a whole number of them a sample."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


def steps_between(start_s: float, end_s: float, wanted_s: float) -> tuple[int, float]:
    """Number and size of equal steps from `start_s` to `end_s`, none longer than `wanted_s` (but for rounding)."""
    span = end_s - start_s
    count = max(1, math.ceil(span / wanted_s * (1.0 - 1e-9)))
    return count, span / count


@dataclass(frozen=True)
class Stretch:
    """A run of equal steps: `samples` intervals of `steps_a_sample` steps each."""

    start_s: float
    end_s: float
    samples: int
    steps_a_sample: int

    @property
    def steps(self) -> int:
        """All steps of the stretch."""
        return self.samples * self.steps_a_sample


def stretches(times_s: npt.NDArray[np.float64], wanted_s: float) -> list[Stretch]:
    """The sample grid as runs of equal steps: all whole intervals, then the shorter last one if there is one."""
    if times_s.size < 2:
        return []
    spans = np.diff(times_s)
    whole = times_s.size - 1
    if spans.size > 1 and spans[-1] < spans[0] * (1.0 - 1e-9):
        whole -= 1
    parts = []
    for first, last in ((0, whole), (whole, times_s.size - 1)):
        if last > first:
            count, _ = steps_between(float(times_s[first]), float(times_s[first + 1]), wanted_s)
            parts.append(Stretch(float(times_s[first]), float(times_s[last]), last - first, count))
    return parts


def actual_step_s(times_s: npt.NDArray[np.float64], wanted_s: float) -> float:
    """The step in use over the whole sample intervals; the wanted one for a run without any."""
    parts = stretches(times_s, wanted_s)
    return (parts[0].end_s - parts[0].start_s) / parts[0].steps if parts else wanted_s
