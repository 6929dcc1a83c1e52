"""Equal steps from sample to sample, with every break of the load at the end of one."""

import itertools

import numpy as np
import pytest

from pinwheel_engines.stepping import legs, stretches

TIMES = np.append(np.arange(11) * 1e-4, 1.05e-3)


def test_without_breaks_the_grid_is_as_ever():
    parts = stretches(TIMES, 1e-5)
    assert [(p.samples, p.steps_a_sample, p.sampled) for p in parts] == [(10, 10, True), (1, 5, True)]


@pytest.mark.parametrize(
    "breaks",
    [[3e-4], [3.33e-4], [3.33e-4, 3.35e-4], [3e-4, 3.33e-4], [1.02e-3], [1e-3], [5e-5, 1e-4, 2.5e-4, 3e-4 + 1e-17]],
)
def test_stretches_meet_at_breaks_and_miss_no_sample(breaks):
    parts = stretches(TIMES, 1e-5, breaks)
    assert parts[0].start_s == 0.0
    assert parts[-1].end_s == TIMES[-1]
    ends = [p.end_s for p in parts]
    assert all(a.end_s == b.start_s for a, b in itertools.pairwise(parts))
    assert all(min(abs(end - b) for end in ends) < 1e-16 for b in breaks)
    assert sum(p.samples for p in parts if p.sampled) == TIMES.size - 1
    assert all((p.end_s - p.start_s) / p.steps < 1e-5 * (1.0 + 1e-6) for p in parts)


def test_breaks_outside_cut_nothing():
    assert stretches(TIMES, 1e-5, [1.05e-3, 2.0]) == stretches(TIMES, 1e-5)
    assert legs(1e-4, 2e-4, [1e-4, 2e-4, 3e-4], 1e-5) == [(1e-4, 2e-4)]
    assert legs(1e-4, 2e-4, [1.5e-4], 1e-5) == [(1e-4, 1.5e-4), (1.5e-4, 2e-4)]
