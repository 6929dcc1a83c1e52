"""Twenty tasks of a user run, and type checkers catch errors before anything runs."""

import subprocess
import sys

import pytest
import twenty_tasks
from conftest import ROOT

# Lines that a type checker must refuse.
WRONG = """\
import pinwheel
pinwheel.Scene("paper", backlsh_m=1)
pinwheel.Scene("paper", discs="two")
pinwheel.Scene("paper").with_(law="papr")
pinwheel.sweep("paper", vary={"backlsh_m": [0.0]})
pinwheel.sweep("paper", vary={"backlash_m": [0.0]}, stp_s=1e-5)
pinwheel.compare("paper").verdicts[0].verdict == "agreed"
pinwheel.gear(ratio=39, pin_circle_diameter_mm=104.0, torque_n_m=200.0)
pinwheel.run("paper")["output_anlge_rad"]
pinwheel.run("paper").plot("output_anlge_rad")
pinwheel.compare("paper")["native"]["external_sleeve_force_m"]
pinwheel.run("paper")["external_sleeve_force_n_400"]
"""
# Lines that it must accept, with the types that it infers.
RIGHT = """\
from collections.abc import Mapping
from typing import assert_type
import numpy as np
import numpy.typing as npt
import pinwheel
run = pinwheel.run("paper")
assert_type(run["external_sleeve_force_n"], npt.NDArray[np.float64])
forces = [run.column(f"external_sleeve_force_n_{k}") for k in range(16)]
run["external_sleeve_force_n_39"] - run["internal_sleeve_force_n_15"]
run["wheel_2_external_penetration_m"][:, 3] - run["external_pin_force_x_n"][:, 3]
peaks = {name: float(run[name].max()) for name in run}
largest = sorted(run, key=lambda name: float(run[name].max()))[-1]
series: Mapping[str, npt.NDArray[np.float64]] = run.columns.to_dict()
plotted = run.plot("eccentric_bearing_force_n_1")
try:
    run = pinwheel.run("steel")
except pinwheel.Diverged as error:
    assert_type(error.partial, pinwheel.Run | None)
with pinwheel.explore("paper") as page:
    assert_type(page.url, str)
"""


def test_twenty_tasks(tmp_path):
    import matplotlib as mpl

    mpl.use("Agg")
    twenty_tasks.main(tmp_path)


def test_types(tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text(WRONG)
    right = tmp_path / "right.py"
    right.write_text(RIGHT)
    tasks = str(ROOT / "python/package_tests/twenty_tasks.py")
    settings = ["--config-file", str(ROOT / "python/pyproject.toml"), "--cache-dir", str(ROOT / "target/mypy-tasks")]
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", *settings, tasks, str(right), str(wrong)],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    errors = [line for line in checked.stdout.splitlines() if ": error:" in line]
    lines = [int(line.split("wrong.py:")[1].split(":")[0]) for line in errors if "wrong.py:" in line]
    assert len(errors) == len(lines), checked.stdout
    assert sorted(set(lines)) == list(range(2, len(WRONG.splitlines()) + 1)), checked.stdout


def test_keys_are_those_of_the_program(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "python"))
    make_keys = pytest.importorskip("make_keys")
    assert make_keys.text() == (ROOT / "python/pinwheel/_keys.py").read_text(), "python -P python/make_keys.py"


def test_help_says_what_attributes_are(capsys):
    import pinwheel

    for kind, message in (
        (pinwheel.Run, "resolution: comparison with a run"),
        (pinwheel.Verdict, "uncertainty: U = u_a + u_b"),
        (pinwheel.Sweep, "cpu_s: CPU time of all runs"),
    ):
        help(kind)
        assert message in capsys.readouterr().out
