"""Defects of earlier versions, a test each."""

import html
import os
import re
import signal
import subprocess
import sys
import threading
import time
from decimal import Decimal

import numpy as np
import pytest
from twenty_tasks import my_euler

import pinwheel
from pinwheel import InputError, Scene, SceneError

SHORT = Scene("paper", duration_s=0.004)


def test_a_comparison_knows_engines_as_they_were_asked_for():
    comparison = pinwheel.compare(SHORT.with_(duration_s=2e-4), ["native", my_euler])
    assert comparison["native"] is comparison["native-reduced"]
    assert comparison[my_euler] is comparison["my-euler"] is comparison["my_euler"]
    with pytest.raises(KeyError, match="did you mean `native-reduced`"):
        comparison["native-reducd"]


def test_two_sweeps_without_a_folder_are_both_there(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    short = SHORT.with_(duration_s=1e-3)
    first = pinwheel.sweep(short, vary={"backlash_m": [0.0, 1e-4]}, engines="native")
    second = pinwheel.sweep(short, vary={"damping_n_s_m": [8.0]}, engines="native")
    assert first.out != second.out
    assert "backlash" in first.page() and (first.out / "results.csv").read_text() != (second.out / "results.csv").read_text()
    # A second call uses the same folder and continues with its content.
    assert pinwheel.sweep(short, vary={"damping_n_s_m": [8.0]}, engines="native", resume=True).out == second.out


@pytest.mark.parametrize("study", ["run", "compare"])
def test_ctrl_c_stops_a_python_engine_where_it_stands(study):
    @pinwheel.engine
    def sleepy(job):
        """Sleeps."""
        time.sleep(20.0)

    begun = time.monotonic()
    threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        SHORT.run(sleepy) if study == "run" else pinwheel.compare(SHORT, [sleepy])
    assert time.monotonic() - begun < 10.0


def test_progress_that_raises_ends_a_python_engine():
    @pinwheel.engine
    def slow(job):
        """Takes its time."""
        for _ in job.times_s:
            time.sleep(0.02)
            job.sample(job.angles, job.rates)

    def refuse(*at):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        SHORT.run(slow, progress=refuse)


def test_a_plot_is_axes_and_is_drawn_once():
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot
    from matplotlib.axes import Axes

    run = SHORT.run("native", check=False)
    axes = run.plot("input_torque_n_m")
    assert isinstance(axes, Axes), "a figure as a cell's value is drawn beside the one that pyplot shows"
    _, mine = pyplot.subplots()
    assert run.plot("input_torque_n_m", ax=mine) is mine
    first = run.plot("input_torque_n_m", "external_sleeve_force_n")
    assert isinstance(first, Axes) and len(first.figure.axes) == 2
    assert isinstance(SHORT.plot(), Axes)
    pyplot.close("all")


def test_figures_come_with_what_is_known_of_them(tmp_path):
    run = SHORT.run("native")
    assert re.search(r"peak \d+ ± \d+ N", str(run)) and str(run) in html.unescape(run._repr_html_())
    assert "samples" in repr(run) and not re.search(r"\d\.\d", repr(run)), "a mean without its uncertainty"
    there = [figure for figure in run.results["figures"] if "withheld" not in figure]
    assert there and all(figure["numerical_uncertainty"] > 0.0 for figure in there)
    run.save(tmp_path)
    assert pinwheel.Run.load(tmp_path).results == run.results
    gear = pinwheel.gear(ratio=39, pin_circle_diameter_mm=104, torque_n_m=200, speed_rpm=1500, ideal=True)
    run, design = gear.with_(duration_s=0.004).run(), pinwheel.statics(gear)
    assert "by contact law" in str(run) and run.by_contact_law["figures"]
    assert str(design["lost_motion_arcmin"]).startswith("lost motion: 0.054 arcmin (0.049 to 0.073 by contact law")
    for figure in design.values():
        assert figure.shown in str(design) and f"<td>{figure.shown}</td>" in design._repr_html_()


def test_no_number_has_no_force():
    law = pinwheel.Law("paper")
    assert np.isnan(law([1e7, np.nan, 1e7], [np.nan, 1e-5, 1e-5], [0.0, 0.0, np.nan])).all()
    assert law(1e7, -1e-6) == 0.0


def test_a_missing_package_is_named_as_pip_knows_it():
    from pinwheel._columns import wanted

    with pytest.raises(ImportError, match=r"pip install nowhere,"):
        wanted("nowhere.pyplot", "plot")


def test_the_function_sweep_stays_one():
    code = "import pinwheel\ntry:\n    import pinwheel.sweep\nexcept ImportError:\n    pass\nassert callable(pinwheel.sweep)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_table_of_statics_shows_figures(tmp_path):
    small = {"points": 2, "backlash_m": {"from": 2e-6, "to": 8e-6}}
    sweep = pinwheel.sweep(Scene("steel"), sample=small, engines="statics", out=tmp_path / "out")
    assert "<th>lost_motion_arcmin</th>" in sweep._repr_html_()


def test_wrong_words_of_a_sweep():
    vary = {"backlash_m": [0.0, 1e-4]}
    with pytest.raises(InputError, match=r"`varry` is no argument of a sweep.*did you mean `vary`"):
        pinwheel.sweep(SHORT, varry=vary)
    with pytest.raises(InputError, match="`time_series`"):
        pinwheel.sweep(SHORT, vary=vary, courses="csv")
    with pytest.raises(InputError, match="jobs = 0"):
        pinwheel.sweep(SHORT, vary=vary, jobs=0)


def test_keys_change_together(tmp_path):
    sweep = pinwheel.sweep(
        SHORT.with_(duration_s=1e-3), together={"wheels": [1, 2], "output_torque_n_m": [11.0, 22.0]}, out=tmp_path / "out"
    )
    assert list(zip(sweep["gear.wheels"], sweep["drive.output_torque_n_m"], strict=True)) == [(1, 11.0), (2, 22.0)]


def test_a_scene_is_read_once(monkeypatch):
    import tomllib

    scene, texts, read = Scene("paper"), [], tomllib.loads
    monkeypatch.setattr(tomllib, "loads", lambda text: texts.append(text) or read(text))
    assert {scene["gear.wheels"] for _ in range(100)} == {2} and len(texts) == 1
    scene["gear"]["wheels"] = 3
    assert scene["gear.wheels"] == 2, "what is handed out is a copy"


def test_progress_never_runs_backwards(monkeypatch):
    import tqdm

    from pinwheel._progress import reporting

    made, shares = [], []
    monkeypatch.setattr(tqdm, "tqdm", lambda **_: made.append(Bar()) or made[-1])
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)

    class Bar:
        n = 0.0

        def set_postfix_str(self, text, refresh):
            pass

        def refresh(self):
            shares.append(self.n / self.total)

        def close(self):
            shares.append("closed")

    with reporting(True, "sweep") as report:
        # Two runs beside each other, then the next begins.
        for done, simulated in ((0, 0.5), (0, 0.2), (1, 0.9), (1, 0.0), (2, 0.0)):
            report(done, 2, "run", simulated, 1.0)
    assert shares == [0.25, 0.25, 0.95, 0.95, 1.0, "closed"]


def test_keys_and_columns_complete_by_tab():
    run = SHORT.run("native", check=False)
    assert {"backlash_m", "gear.backlash_m"} <= set(SHORT._ipython_key_completions_())
    assert {"external_sleeve_force_n", "external_sleeve_force_n_3"} <= set(run._ipython_key_completions_())
    assert "lost_motion_arcmin" in pinwheel.statics("steel")._ipython_key_completions_()


def test_numbers_of_all_kinds():
    assert Scene("paper", wheels=2.0) == Scene("paper", wheels=np.float64(2)) == Scene("paper", wheels=2)
    assert Scene("paper", backlash_m=Decimal("0.0006")) == Scene("paper", backlash_m=6e-4)
    with pytest.raises(SceneError, match=r"gear.wheels.*whole number"):
        Scene("paper", wheels=2.5)
    for nothing in (None, {1, 2}):
        with pytest.raises(TypeError, match="`backlash_m`"):
            Scene("paper", backlash_m=nothing)


def test_units_typed_with_numbers():
    with pytest.raises(SceneError, match=r"did you mean 0\.0006\?"):
        Scene("paper", backlash_m="0.6 mm")
    with pytest.raises(SceneError, match=r"`gear\.pin_circle_radius_m`.*metres"):
        Scene("paper", pin_circle_radius_m=52.0, eccentricity_m=0.75, external_sleeve_radius_m=2.0)


def test_remedies_of_a_text_are_ways_of_python(tmp_path):
    texts = []
    ideal = pinwheel.gear(ratio=39, pin_circle_diameter_mm=104, torque_n_m=200, speed_rpm=1500, ideal=True)
    for scene, engines in (
        (SHORT, ["native", "native-lagrange"]),
        ("steel", ["native", my_euler]),
        (ideal.with_(duration_s=0.004), ()),
    ):
        comparison = pinwheel.compare(scene, engines, longest_s=0.5)
        texts.append(str(comparison))
        assert "--" not in comparison.details()
    texts += [str(pinwheel.statics("steel")), str(pinwheel.explain("paper"))]
    texts.append(str(pinwheel.sweep(SHORT, vary={"backlash_m": [0.0, 1e-4]}, engines="native", out=tmp_path / "out")))
    cargo = "cargo install --path crates/cli --features crossval"  # adds engines that Python cannot
    for text in texts:
        words = " ".join(text.split()).replace(cargo, "")
        assert not re.findall(r"--[a-z]+", words), text
        assert max(len(line) for line in text.splitlines()) <= 80, text


def test_flags_are_said_in_python():
    from pinwheel._page import plain

    for text, here in (
        ("of 2026-11-28; --fresh runs them", "`fresh=True` runs them"),
        ("not here; build with --features crossval", "where it is built with its feature crossval"),
        ("not asked for; run it without --engines", "not asked for; name no engines"),
        ("timed out; Engines on the page says what each needs (--longest SECONDS)", "(`longest_s=SECONDS`)"),
        ("ask for more of rapier: --longest 300; or leave it out", "ask for more of rapier: `longest_s=300`; or"),
        ("refine mine or leave it out: --engines", "refine mine or leave it out of `engines`"),
        ("leave it out with --engines, or change the scene", "leave it out by `engines`, or change"),
        ("give it more time (--longest) or a smaller", "give it more time (`longest_s`) or a smaller"),
        ("and 3 more: --verbose, or Engines on the page", "and 3 more: `details()`, or"),
        (
            "measurement   nothing; --against rig.csv\n              --map rig.toml would",
            '`against=[("rig.csv", "rig.toml")]` would',
        ),
        ("for these rollers: --set contact.law=line-hertz, or say", '`with_({"contact.law": "line-hertz"})`, or'),
        ("--set solver.step_s=1e-6", '`with_({"solver.step_s": 1e-6})`'),
        ("pinwheel design of this scene", "`pinwheel.design` of this scene"),
    ):
        assert here in " ".join(plain(text).split()), plain(text)
    # Cells without a flag stay as they are, line for line.
    table = "a  b\n1  2\n\n   x\n    y\nlabel         text that\n              goes on"
    assert plain(table) == table


def test_what_ran_until_it_diverged_is_a_run():
    wild = Scene("steel", integrator="rk2", step_s=1e-4, duration_s=0.05)
    with pytest.raises(pinwheel.Diverged) as caught:
        wild.run("native", check=False)
    partial = caught.value.partial
    assert isinstance(partial, pinwheel.Run) and 0 < partial.time_s.size < 501


def test_how_long_and_how_sharp_a_comparison_is():
    sharp = pinwheel.compare(SHORT, ["native", "native-lagrange"], resolution=1e-4)
    assert sharp.data["resolution"] == 1e-4
    for wrong in ({"longest_s": -1.0}, {"resolution": 0.0}, {"resolution": 2.0}):
        with pytest.raises(InputError, match=next(iter(wrong)).split("_")[0]):
            pinwheel.compare(SHORT, ["native"], **wrong)


def test_an_outer_diameter_suggests_the_pin_circle():
    given = {"ratio": 39, "torque_n_m": 200, "speed_rpm": 1500}
    outer, circle = pinwheel.gear(**given, outer_diameter_mm=133), pinwheel.gear(**given, pin_circle_diameter_mm=104)
    assert all(outer[key] == circle[key] for key in ("gear.eccentricity_m", "gear.external_sleeve_radius_m"))
    with pytest.raises(InputError, match="either pin_circle_diameter_mm or outer_diameter_mm"):
        pinwheel.gear(**given, outer_diameter_mm=133, pin_circle_diameter_mm=104)
