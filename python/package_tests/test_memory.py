"""Memory of many runs: one copy of their data."""

import gc
import sys
from pathlib import Path

import pytest

from pinwheel import Scene

# 1 001 samples of 28 columns: 224 kB.
SCENE = Scene("paper", duration_s=0.01, sample_s=1e-5)
BYTES = 1001 * 28 * 8


def resident():
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_a_thousand_runs_keep_their_data_once():
    warm = [SCENE.run("native", check=False) for _ in range(5)]
    before = resident()
    kept = [SCENE.run("native", check=False) for _ in range(1000)]
    # Access to existing columns makes no copy.
    assert sum(run["external_sleeve_force_n"].size for run in kept) == 1000 * 1001 * 16
    each = (resident() - before) / 1000
    print(f"{each / BYTES:.2f} of their data")
    assert 0.9 * BYTES < each < 1.15 * BYTES
    # Freed memory is used again: the allocator need not return it to the system.
    del kept
    kept = [SCENE.run("native", check=False) for _ in range(1000)]
    assert resident() - before < 1.15 * 1000 * BYTES
    assert warm and kept
