"""Runs: the program's numbers, shapes, libraries, Ctrl-C, threads, divergence, laws."""

import importlib.util
import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest

import pinwheel
from pinwheel import Diverged, Scene

SHORT = Scene("paper", duration_s=0.01)


@pytest.mark.parametrize("engine", ["native-reduced", "native-resolved", "rapier-shared-law"])
def test_the_programs_numbers_to_the_bit(engine, program, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(SHORT.to_toml())
    program("run", "scene.toml", "--engine", engine, "--out", "out", cwd=tmp_path)
    SHORT.run(engine).to_csv(tmp_path / "ours.csv")
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "out/courses.csv").read_bytes()


def test_shapes_and_libraries():
    run = SHORT.run("native-reduced")
    assert run["external_sleeve_force_n"].shape == (101, 16)
    assert run["external_sleeve_force_n_3"].base is not None, "a view"
    assert np.array_equal(run["external_sleeve_force_n"][:, 3], run["external_sleeve_force_n_3"])
    assert run["input_torque_n_m"].shape == run.time_s.shape == (101,)
    assert run.stats["bodies"] == 28 and run.resolution is not None
    assert np.array_equal(run.column(f"external_sleeve_force_n_{3}"), run["external_sleeve_force_n_3"])
    for ask in (run.column, run.__getitem__):
        with pytest.raises(KeyError, match="did you mean `input_torque_n_m`") as raised:
            ask("input_torque_nm")
        assert isinstance(raised.value, pinwheel.PinwheelError) and str(raised.value).startswith("no column")
    with pytest.raises(ValueError, match="read-only"):
        run["input_torque_n_m"][0] = 0.0
    frame, polar, cube = run.to_pandas(), run.to_polars(), run.to_xarray()
    assert frame.shape == (101, 27) and frame.index.name == "time_s"
    assert polar.columns[:2] == ["time_s", "input_torque_n_m"]
    assert cube["external_sleeve_force_n"].dims == ("time_s", "external_sleeve")
    assert cube["external_sleeve_force_n"].attrs == {"units": "N", "long_name": "ring pin force"}
    assert cube.attrs["Conventions"].startswith("CF-") and cube["external_sleeve"].attrs["units"] == "1"
    assert "driver torque" in str(run) and "<pre" in run._repr_html_()
    again = pickle.loads(pickle.dumps(run))
    assert again.scene == run.scene and again.stats == run.stats and again.to_pandas().equals(frame)


def test_pictures(tmp_path):
    import matplotlib

    matplotlib.use("Agg")
    axes = SHORT.run("native-reduced").plot("input_torque_n_m", "external_sleeve_force_n")
    first, second = axes.figure.axes
    assert first.get_ylabel() == "driver torque, N m" and len(second.get_legend().get_texts()) == 16


def test_ctrl_c_stops_a_run():
    begun = time.monotonic()
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        Scene("paper", duration_s=100.0, sample_s=0.01).run("native-reduced", check=False)
    # Minutes of work, stopped at the next sample.
    assert time.monotonic() - begun < 30.0


def test_other_threads_run_meanwhile():
    ticks = []
    over = threading.Event()

    def tick():
        while not over.wait(1e-3):
            ticks.append(None)

    other = threading.Thread(target=tick)
    other.start()
    Scene("paper", duration_s=0.5).run("native-reduced", check=False)
    over.set()
    other.join()
    assert len(ticks) > 20, "the interpreter's lock was held"


def test_progress_is_told_and_its_exception_ends_the_run():
    reports = []
    Scene("paper", duration_s=0.3).run("native-reduced", check=False, progress=lambda *at: reports.append(at))
    assert reports[-1][0] == reports[-1][1] == 1

    def refuse(*at):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        Scene("paper", duration_s=100.0, sample_s=0.01).run("native-reduced", check=False, progress=refuse)


def test_a_divergence_keeps_what_there_is():
    with pytest.raises(Diverged) as caught:
        Scene("paper", duration_s=0.05, step_s=1e-4).run("native-reduced")
    error = caught.value
    assert error.engine == "native-reduced" and 0.0 < error.time_s < 0.05 and error.quantity
    assert 0 < error.partial.time_s.size < 501


def test_bad_input_of_engines():
    with pytest.raises(pinwheel.NoEngine, match="did you mean"):
        SHORT.run("native-reducd")
    with pytest.raises(pinwheel.NoEngine, match="named twice"):
        pinwheel.compare(SHORT, ["native-reduced", "native-reduced"])
    with pytest.raises(pinwheel.InputError, match=r"@pinwheel\.engine"):
        SHORT.run(3)


def test_comparison(tmp_path):
    comparison = pinwheel.compare(SHORT.with_(step_s=2e-6), ["native-reduced", "native-lagrange", "rapier-shared-law"])
    assert comparison.passed and set(comparison.engines.values()) == {"finished"}
    assert {v.verdict for v in comparison.verdicts} <= {"agree"}
    agree = [v for v in comparison.verdicts if v.verdict == "agree"]
    assert agree and all(v.distance <= v.uncertainty for v in agree)
    assert comparison["rapier-shared-law"]["external_sleeve_force_n"].shape == (101, 16)
    page = comparison.show(tmp_path / "page.html").read_text()
    assert page.startswith("<!") and "rapier-shared-law" in page
    assert len(comparison.to_pandas()) == len(comparison.verdicts) and "<table>" in comparison._repr_html_()
    tidy = comparison.time_series_to_pandas()
    assert list(tidy) == ["engine", "time_s", "column", "value"]
    for engine, columns in comparison.runs.items():
        mine = tidy[(tidy["engine"] == engine) & (tidy["column"] == "input_torque_n_m")]
        assert np.array_equal(mine["value"], columns["input_torque_n_m"])
    assert "PASS, ONE CONTACT LAW" in str(comparison)


def test_law_on_arrays():
    law = pinwheel.Law("paper", damping_n_s_m=0.0, ramp_m=1e-9)
    depth = np.linspace(-1e-5, 4e-5, 11)
    expected = np.where(depth > 0.0, 9e7 * np.abs(depth) ** 1.5, 0.0)
    # Rounding of a power against a product of roots: 2 units in the last place, times 4.
    np.testing.assert_allclose(law(9e7, depth), expected, rtol=1e-15 * 2 * 4)
    assert law([[9e7], [8e7]], depth).shape == (2, 11)
    assert np.array_equal(pickle.loads(pickle.dumps(law))(9e7, depth), law(9e7, depth))
    with pytest.raises(pinwheel.InputError, match="did you mean"):
        pinwheel.Law("papr")
    assert {"paper", "hunt-crossley"} <= {law.name for law in pinwheel.laws()}


def test_the_program_has_the_engines_of_this_python(program, tmp_path):
    here = {engine.name for engine in pinwheel.engines()}
    listed = {line.split()[0] for line in program("engines", cwd=tmp_path).splitlines() if line.strip()}
    assert here - {"native"} <= listed
    if importlib.util.find_spec("exudyn"):
        short = ("--set", "solver.duration_s=0.002")
        assert "exudyn" in program("run", "paper", "--engine", "exudyn-shared-law-explicit", *short, cwd=tmp_path)
    else:
        assert "pip install exudyn==" in program("engines", cwd=tmp_path)
