"""Solvers written in Python beside the others."""

import numpy as np
import pytest

import pinwheel
from pinwheel import Scene

SHORT = Scene("paper", duration_s=0.004)


@pinwheel.engine(track="shared-law", order=4)
def my_rk4(job):
    """Runge-Kutta 4 in numpy on the gear's absolute angles."""

    def slope(time_s, y):
        angles, rates = y
        accelerations = job.torques(time_s, angles, rates) / job.moments
        accelerations[job.INPUT] = 0.0  # the driver holds the input's speed
        return np.array([rates, accelerations])

    y = np.array([job.angles, job.rates])
    job.sample(*y)
    for steps in job.intervals():
        for t, h in steps:
            job.at(t, h)
            k1 = slope(t, y)
            k2 = slope(t + h / 2, y + h / 2 * k1)
            k3 = slope(t + h / 2, y + h / 2 * k2)
            k4 = slope(t + h, y + h * k3)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        job.sample(*y)


def test_it_solves_the_same_equations():
    native = SHORT.with_(integrator="rk4").run("native-reduced", check=False)
    mine = SHORT.run(my_rk4)
    assert mine.engine == "my-rk4" and mine.stats["rhs_calls"] == 4 * mine.stats["steps"] == 1600
    for name in ("input_torque_n_m", "output_torque_n_m", "external_sleeve_force_n"):
        # Two programs with equal method, step and law: 3e-12 of the peak by rounding, times 30.
        assert np.max(np.abs(mine[name] - native[name])) < 1e-10 * np.max(np.abs(native[name])), name


def test_comparison_takes_it():
    comparison = pinwheel.compare(SHORT, ["native-reduced", my_rk4])
    assert comparison.passed and {v.verdict for v in comparison.verdicts} == {"agree"}
    mine = next(engine for engine in comparison.data["engines"] if engine["name"] == "my-rk4")
    assert mine["refinement"]["order"] == 4.0


def test_sweep_and_bench_take_it(tmp_path):
    sweep = pinwheel.sweep(
        SHORT.with_(duration_s=1e-3), vary={"backlash_m": [0.0, 1e-4]}, engines=["native", my_rk4], out=tmp_path / "out"
    )
    assert list(sweep["engine"]) == ["native-reduced", "my-rk4"] * 2 and not sweep.unfinished
    assert np.ptp(sweep["mean_input_torque_n_m"][:2]) < 1e-3 * sweep["mean_input_torque_n_m"][0]
    measured = pinwheel.bench(SHORT.with_(duration_s=1e-3), [my_rk4], longest_s=0.5, repeats=1)
    assert any(row["engine"] == "my-rk4" for row in measured.rows)


def test_its_exception_is_the_cause():
    @pinwheel.engine
    def broken(job):
        """Breaks."""
        raise ZeroDivisionError("no luck")

    with pytest.raises(pinwheel.EngineFailed, match="ZeroDivisionError: no luck") as caught:
        SHORT.run(broken)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    with pytest.raises(pinwheel.EngineFailed, match="ZeroDivisionError: no luck") as caught:
        pinwheel.compare(SHORT, ["native-reduced", broken])
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert caught.value.comparison.engines["broken"] == "failed" and not caught.value.comparison.passed


def test_an_engine_of_which_nothing_is_shown_does_not_pass():
    @pinwheel.engine
    def no_number(job):
        """Returns what is no run."""
        return 42

    @pinwheel.engine
    def wild(job):
        """Gives numbers that are none."""
        job.sample(job.angles * np.nan, job.rates)

    for engine, error in [(no_number, pinwheel.EngineFailed), (wild, None)]:
        try:
            comparison = pinwheel.compare(SHORT, ["native-reduced", engine])
            assert error is None
        except pinwheel.EngineFailed as caught:
            assert error is not None
            comparison = caught.comparison
        assert not comparison.passed and f"{engine.name}: nothing shown: its run" in comparison.findings[0]
        assert comparison.findings[0].split(":")[0] in str(comparison).splitlines()[3]


def test_it_cannot_end_early_or_run_away():
    @pinwheel.engine
    def lazy(job):
        """Takes one sample."""
        job.sample(job.angles, job.rates)

    @pinwheel.engine
    def wild(job):
        """Gives numbers that are none."""
        job.sample(job.angles, job.rates)
        job.sample(job.angles * np.nan, job.rates)

    with pytest.raises(pinwheel.EngineFailed, match="took 1 of 41 samples"):
        SHORT.run(lazy)
    with pytest.raises(pinwheel.Diverged) as caught:
        SHORT.run(wild)
    assert caught.value.partial.time_s.size == 1


def test_names_and_versions():
    with pytest.raises(pinwheel.InputError, match="another name"):
        pinwheel.engine(name="native-reduced")(lambda job: None)
    assert my_rk4.version != pinwheel.engine(name="other")(lambda job: None).version


def test_exudyn_and_mujoco_in_this_interpreter():
    names = [engine.name for engine in pinwheel.engines()]
    assert "mujoco-shared-law" in names and "exudyn-shared-law-explicit" in names
    comparison = pinwheel.compare(SHORT, ["native-resolved", "mujoco-shared-law", "exudyn-shared-law-explicit"])
    assert set(comparison.engines.values()) == {"finished"}
    assert {v.verdict for v in comparison.verdicts} == {"agree"}
