"""Fixed steps that hit every sample: the step is the wanted one or a little less, a whole number of them a sample."""

from __future__ import annotations

import math


def steps_between(start_s: float, end_s: float, wanted_s: float) -> tuple[int, float]:
    """Number and size of equal steps from `start_s` to `end_s`, none longer than `wanted_s` (but for rounding)."""
    span = end_s - start_s
    count = max(1, math.ceil(span / wanted_s * (1.0 - 1e-9)))
    return count, span / count
