"""Fixtures of the tests of the package pinwheel, which run from this folder in an environment with the package."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# A shell that runs the tests in the background has them ignore it.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def program():
    """Runs the program that comes with the package."""

    def run(*arguments, cwd, status=0):
        done = subprocess.run(
            [sys.executable, "-m", "pinwheel", *arguments], cwd=cwd, capture_output=True, text=True, check=False
        )
        assert done.returncode == status, done.stderr
        return done.stdout

    return run


SWEEP = """\
name = "small"
scene = "paper"
engines = ["native-reduced"]
[set]
solver.duration_s = 0.004
[vary]
gear.backlash_m = { from = 0.0, to = 3.0e-4, points = 20 }
contact.damping_n_s_m = [8.0, 16.0]
"""


@pytest.fixture
def sweep_file(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text(SWEEP)
    return path
