"""Engines with the shared law: against an independent Runge-Kutta, order, borders, and each guard provoked.

The runs are short because the numpy law takes about a millisecond a call.
"""

import ctypes
from typing import Any

import mujoco
import numpy as np
import pytest

from pinwheel_engines import Cancelled, Diverged, EngineFailed, FrozenForces, SceneError, Unsupported, run
from pinwheel_engines.border import StageLaw, check_not_frozen
from pinwheel_engines.guards import Guard
from pinwheel_engines.layout import Kinematics
from pinwheel_engines.mujoco import session as mujoco_session
from pinwheel_engines.mujoco import shared_law
from tests import scenes

EXPLICIT = ["mujoco-shared-law", "exudyn-shared-law-explicit"]
SHARED = [*EXPLICIT, "exudyn-shared-law-constrained"]


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    """Every test runs in an empty folder and leaves it empty."""
    monkeypatch.chdir(tmp_path)
    yield
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def references():
    """Courses of the plain Runge-Kutta at the engines' own step."""
    return {name: scenes.runge_kutta(scenes.scene(text, 1e-3), 1e-5) for name, text in scenes.ALL.items()}


@pytest.mark.parametrize("engine", EXPLICIT)
@pytest.mark.parametrize("name", scenes.ALL)
def test_same_method_gives_the_same_courses(engine, name, references):
    result = run(scenes.scene(scenes.ALL[name], 1e-3), engine)
    # The Runge-Kutta method on other coordinates (relative angles, engine's mass matrix): rounding only, measured 3.5e-13.
    assert scenes.worst_rms(result.columns, references[name]) < 1e-11
    assert result.stats.steps == 100
    assert result.stats.rhs_calls >= 400
    assert result.stats.step_s == pytest.approx(1e-5)


@pytest.mark.parametrize("engine", SHARED)
@pytest.mark.parametrize("loss", ["sleeve_friction_coefficient = 0.1\nsleeve_bore_m = 0.005", "output_seal_n_m = 0.5"])
def test_numpy_law_refuses_the_losses_it_leaves_out(engine, loss):
    with pytest.raises(Unsupported, match=f"bearings.{loss.split()[0]}: the numpy law has contacts alone"):
        run(f"{scenes.paper_text()}[bearings]\n{loss}\n", engine)


def test_constrained_form_is_of_second_order():
    scene = scenes.scene("", 1e-3)
    wanted = scenes.runge_kutta(scene, 5e-6)
    errors = [
        scenes.relative_rms(run(scene, "exudyn-shared-law-constrained", step_s=h).columns, wanted, "external")
        for h in (2e-5, 1e-5)
    ]
    assert errors[1] < 1e-2
    assert 3.5 < errors[0] / errors[1] < 4.5


def test_constrained_form_solves_friction():
    scene = scenes.scene(scenes.FRICTION, 5e-4)
    result = run(scene, "exudyn-shared-law-constrained")
    wanted = scenes.runge_kutta(scene, 1e-6)
    # Measured 5.3e-4 and below at 1e-5 s, where an explicit method needs 2e-7 s.
    assert scenes.worst_rms(result.columns, wanted) < 2e-3
    assert result.stats.joint_drift_m is not None
    # Joints hold at velocity level; the trapezoidal rule then drifts by a part of h^2 e omega^2: 1.7e-11 m measured.
    assert result.stats.joint_drift_m < 1e-10


@pytest.mark.parametrize("engine", SHARED)
def test_ramped_load_and_uneven_end(engine):
    text = "[drive]\nload_ramp_s = 0.0002\n"
    result = run(scenes.scene(text, 3.5e-4), engine, step_s=2e-5)
    wanted = scenes.wanted(text, 3.5e-4, 2e-5)
    assert result.columns["time_s"].tolist() == wanted["time_s"].tolist()
    assert result.columns["time_s"][-1] == 3.5e-4
    limit = 1e-8 if engine in EXPLICIT else 5e-2
    assert scenes.worst_rms(result.columns, wanted) < limit


# A jump between samples and steps, a ramp that ends where the load jumps again, and a jump on a sample.
CHANGES = """[drive]
start = "equilibrium"
load_changes = [
  { time_s = 0.000133, output_torque_n_m = 44.0, ramp_s = 0.0 },
  { time_s = 0.000401, output_torque_n_m = -22.0, ramp_s = 0.0001 },
  { time_s = 0.0007, output_torque_n_m = 11.0, ramp_s = 0.0 },
]
"""


@pytest.mark.parametrize("engine", SHARED)
def test_load_that_changes(engine):
    result = run(scenes.scene(CHANGES, 1e-3), engine, step_s=1e-5)
    wanted = scenes.wanted(CHANGES, 1e-3, 1e-5)
    # Measured 8e-14 for Runge-Kutta 4, whose steps are the same, and 7.0e-4 for the trapezoidal rule; steps that pass
    # over the breaks are off by 6.8e-2 at least.
    limit = 1e-10 if engine in EXPLICIT else 2e-3
    assert scenes.worst_rms(result.columns, wanted) < limit


@pytest.mark.parametrize("engine", SHARED)
def test_loaded_start_has_no_transient(engine):
    scene = scenes.scene('[drive]\nstart = "equilibrium"\n', 5e-4)
    columns = run(scene, engine, step_s=2e-5).columns
    assert columns["output_torque_n_m"][0] == pytest.approx(-22.0, abs=0.05)
    assert np.max(np.abs(columns["output_torque_n_m"] + 22.0)) < 1.0
    assert columns["input_torque_n_m"] == pytest.approx(1.4529, rel=0.1)


@pytest.mark.parametrize("engine", SHARED)
def test_given_initial_states(engine):
    scene = scenes.scene("", 1e-4)
    kinematics = Kinematics(scene.gear)
    angles, rates = kinematics.ideal(scene)
    angles[1] += 1e-4
    columns = run(scene, engine, initial_states=kinematics.states(angles, rates)).columns
    assert columns["output_angle_rad"][0] == angles[1]
    assert columns["internal_sleeve_force_n_0"].max() > 0.0 or columns["internal_sleeve_force_n_2"].max() > 0.0


def test_runs_repeat_to_the_bit_and_engines_alternate():
    scene = scenes.scene("", 2e-4)
    firsts, seconds = ([run(scene, engine).columns for engine in SHARED] for _ in range(2))
    for first, second in zip(firsts, seconds, strict=True):
        assert all(np.array_equal(first[n], second[n]) for n in first)


@pytest.mark.parametrize("engine", SHARED)
def test_compiled_law_gives_the_numpy_laws_bits(engine):
    scene = scenes.scene("", 2e-4)
    plain = scenes.PlainLaw(scene)
    a, b = run(scene, engine, law=plain.pointer), run(scene, engine)
    assert all(np.array_equal(a.columns[n], b.columns[n]) for n in a.columns)
    assert "compiled law" in a.stats.settings


def test_direct_callback_over_the_layout():
    scene = scenes.scene(scenes.ELEVEN, 1e-4)
    plain = scenes.PlainLaw(scene, direct=True)
    a, b = run(scene, "mujoco-shared-law", law=plain.pointer), run(scene, "mujoco-shared-law")
    assert scenes.worst_rms(a.columns, b.columns) < 1e-12
    assert plain.detached == 1
    assert a.stats.rhs_calls == b.stats.rhs_calls == 40


def test_mujocos_jacobian_agrees_with_the_borders():
    """The layout's way from loads to joint torques, against MuJoCo's own."""
    scene = scenes.scene(scenes.ELEVEN)
    machine = shared_law._Machine(scene, 1e-5, StageLaw(scene, None), None)
    model, data = machine.model, machine.data
    rng = np.random.default_rng(8)
    data.qpos[:] = rng.normal(size=model.nq)
    mujoco.mj_forward(model, data)
    loads = rng.normal(size=(machine.kinematics.layout.bodies, 3))
    torques = np.zeros(model.nv)
    for body, load in enumerate(loads):
        number = model.body(f"b{body}").id
        force, moment = np.array([load[0], load[1], 0.0]), np.array([0.0, 0.0, load[2]])
        mujoco.mj_applyFT(model, data, force, moment, data.xipos[number], number, torques)
    expected = machine.kinematics.relative_torques(machine.absolute()[0], loads)
    np.testing.assert_allclose(torques[machine.coordinate], expected, rtol=1e-12, atol=1e-12)


# Guards, each provoked.


@pytest.mark.parametrize("engine", SHARED)
def test_blow_up_is_an_error_with_the_courses_until_then(engine):
    # Real steel at a step two thousand times too long.
    scene = scenes.scene("[contact]\nstiffness_multiplier = 1.0\n", 0.05, sample_s=1e-3)
    with pytest.raises(Diverged) as caught:
        run(scene, engine, step_s=1e-3)
    error = caught.value
    assert 0.0 < error.time_s <= 0.05
    assert engine in str(error)
    assert error.partial is not None
    times = error.partial.columns["time_s"]
    assert times.size >= 1
    assert times[-1] < error.time_s + 1e-12
    assert all(np.all(np.isfinite(c)) for c in error.partial.columns.values())
    # The process stays usable.
    assert run(scenes.scene("", 1e-4), engine).columns["time_s"].size == 2


def test_mujocos_reset_is_seen():
    scene = scenes.scene()
    guard = Guard("mujoco-shared-law", scene)
    model = mujoco.MjModel.from_xml_string(shared_law.model_xml(scene, 1e-5))
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    data = mujoco.MjData(model)
    with mujoco_session.quiet_session():
        mujoco.mj_step(model, data, 10)
        mujoco_session.check_data(guard, data, 1e-4)
        # The clock alone, without a warning.
        mujoco.mj_resetData(model, data)
        with pytest.raises(Diverged, match="reset its state"):
            mujoco_session.check_data(guard, data, 1e-4)
        # A bad velocity: MuJoCo restarts and steps on.
        data.qvel[3] = np.nan
        mujoco.mj_step(model, data, 3)
        assert np.all(np.isfinite(data.qvel))
        with pytest.raises(Diverged, match="qvel"):
            mujoco_session.check_data(guard, data, 3e-5)


def test_impossible_states_and_forces_are_seen():
    scene = scenes.scene()
    guard = Guard("x", scene)
    angles, rates = Kinematics(scene.gear).ideal(scene)
    guard.check_states(0.0, angles, rates)
    for body, which, value in ((0, 1, 50.0), (2, 0, 0.5), (1, 0, 0.5), (5, 0, np.nan), (5, 1, np.inf)):
        wrong = [angles.copy(), rates.copy()]
        wrong[which][body] = value if which else wrong[0][body] + value
        with pytest.raises(Diverged):
            guard.check_states(0.0, wrong[0], wrong[1])
    guard.check_forces(0.0, np.array([500.0, -500.0]))
    for force in (1e8, np.nan, np.inf):
        with pytest.raises(Diverged, match="sleeve force"):
            guard.check_forces(0.0, np.array([1.0, force]))


def test_a_callback_that_is_not_called_per_stage_is_seen():
    scene = scenes.scene("", 2e-4)
    # A callback that works but does not count stands for one that MuJoCo calls too rarely.
    silent = scenes.PlainLaw(scene, direct=True, counting=False)
    with pytest.raises(FrozenForces, match="0 times in 20 steps"):
        run(scene, "mujoco-shared-law", law=silent.pointer)
    assert silent.detached == 1


@pytest.mark.parametrize("engine", EXPLICIT)
def test_forces_frozen_over_a_step_are_seen(engine, monkeypatch):
    original = Kinematics.states
    held: dict[str, Any] = {"calls": 0}

    def stale(self, angles, rates, out=None):
        """Hands the law the same state for all stages of two steps."""
        held["calls"] += 1
        if "angles" not in held or held["calls"] % 8 == 0:
            held["angles"], held["rates"] = angles.copy(), rates.copy()
        return original(self, held["angles"], held["rates"], out)

    monkeypatch.setattr(Kinematics, "states", stale)
    with pytest.raises((FrozenForces, EngineFailed, Diverged)) as caught:
        run(scenes.scene("", 2e-4), engine)
    # MuJoCo's positions are compared with the law's at every sample; exudyn's run shows by its count.
    assert isinstance(caught.value, EngineFailed if engine.startswith("mujoco") else FrozenForces)


def test_frozen_forces_by_count():
    check_not_frozen("x", steps=10, stages=4, calls=40, changes=40)
    with pytest.raises(FrozenForces, match="10 times in 10 steps of 4 stages"):
        check_not_frozen("x", steps=10, stages=4, calls=10, changes=10)
    with pytest.raises(FrozenForces, match="different states"):
        check_not_frozen("x", steps=10, stages=4, calls=40, changes=10)


@pytest.mark.parametrize("engine", SHARED)
def test_a_python_error_in_a_stage_arrives_with_its_text(engine, monkeypatch):
    original = StageLaw.evaluate
    calls = {"n": 0}

    def fails(self, time_s):
        calls["n"] += 1
        if calls["n"] > 20:
            raise ZeroDivisionError("on purpose")
        return original(self, time_s)

    with monkeypatch.context() as patch:
        patch.setattr(StageLaw, "evaluate", fails)
        with pytest.raises(EngineFailed, match="ZeroDivisionError: on purpose"):
            run(scenes.scene("", 1e-3), engine)
    assert mujoco.get_mjcb_passive() is None
    assert run(scenes.scene("", 1e-4), engine).stats.steps == 10


@pytest.mark.parametrize("engine", SHARED)
def test_progress_and_cancel(engine):
    times_s = []

    def progress(time_s):
        times_s.append(time_s)
        return time_s > 2.5e-4

    with pytest.raises(Cancelled):
        run(scenes.scene("", 1e-3), engine, on_progress=progress)
    assert times_s == pytest.approx([0.0, 1e-4, 2e-4, 3e-4])


def test_callbacks_of_others_are_put_back():
    function = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(lambda _m, _d: None)
    mujoco.set_mjcb_control(function)
    try:
        run(scenes.scene("", 1e-4), "mujoco-shared-law")
        assert mujoco.get_mjcb_control() is function
    finally:
        mujoco.set_mjcb_control(None)


def test_what_cannot_be_run_is_said():
    with pytest.raises(Unsupported, match="no such engine"):
        run("", "adams")
    with pytest.raises(SceneError):
        run("gear = 3", "mujoco-shared-law")
    with pytest.raises(Unsupported, match="knows only"):
        run(scenes.scene('[contact]\nlaw = "other"'), "exudyn-shared-law-explicit")
    with pytest.raises(Unsupported, match="takes only more than"):
        run(scenes.scene("[mass.external_sleeve]\nmass_kg = 1e-9\nmoment_kg_m2 = 1e-16"), "mujoco-shared-law")
    # A compiled law may know it.
    scene = scenes.scene("", 1e-4)
    # Kept by name: its function must outlive the run.
    plain = scenes.PlainLaw(scene)
    other = scene.with_keys("contact", law="other")
    assert run(other, "exudyn-shared-law-explicit", law=plain.pointer).stats.steps == 10


def test_columns_are_the_contracts():
    scene = scenes.scene(scenes.ELEVEN, 1e-4)
    result = run(scene, "mujoco-shared-law")
    names = list(result.columns)
    assert names[:4] == ["time_s", "input_torque_n_m", "output_torque_n_m", "output_angle_rad"]
    assert names[4] == "external_sleeve_force_n_0"
    assert names[-1] == "internal_sleeve_force_n_5"
    lines = result.to_csv().splitlines()
    assert lines[0].split(",") == names
    assert [float(x) for x in lines[-1].split(",")] == [float(c[-1]) for c in result.columns.values()]
