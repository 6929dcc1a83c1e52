"""Kinematics, the mesh and the loaded start."""

import numpy as np
import pytest

from pinwheel_engines import ContactLaw, SceneError
from pinwheel_engines.layout import Kinematics
from pinwheel_engines.start import initial_angles
from pinwheel_engines.stepping import actual_step_s, steps_between, stretches
from tests import scenes

EXACT = {name: text for name, text in scenes.ALL.items() if name != "points"}


@pytest.mark.parametrize("name", scenes.ALL)
def test_torques_are_the_transpose_of_velocities(name):
    scene = scenes.scene(scenes.ALL[name])
    kinematics = Kinematics(scene.gear)
    rng = np.random.default_rng(4)
    count = kinematics.layout.bodies
    angles, rates, loads = rng.normal(size=count), rng.normal(size=count), rng.normal(size=(count, 3))
    states = kinematics.states(angles, rates)
    power = float(np.sum(loads * states[:, 3:]))
    assert power == pytest.approx(float(kinematics.torques(angles, loads) @ rates), rel=1e-12)
    relative = kinematics.relative(rates)
    assert power == pytest.approx(float(kinematics.relative_torques(angles, loads) @ relative), rel=1e-12)
    np.testing.assert_allclose(kinematics.absolute(relative), rates, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("name", scenes.ALL)
def test_velocities_are_rates_of_positions(name):
    kinematics = Kinematics(scenes.scene(scenes.ALL[name]).gear)
    rng = np.random.default_rng(6)
    count, h = kinematics.layout.bodies, 1e-6
    angles, rates = rng.normal(size=count), rng.normal(size=count)
    ahead, back = kinematics.states(angles + h * rates, rates), kinematics.states(angles - h * rates, rates)
    np.testing.assert_allclose((ahead - back)[:, :3] / (2 * h), kinematics.states(angles, rates)[:, 3:], atol=1e-9)


@pytest.mark.parametrize("name", ["paper", "eleven", "one-wheel", "ring"])
@pytest.mark.parametrize("time_s", [0.0, 0.0137, 0.31])
def test_the_ideal_mesh_fits_without_clearance(name, time_s):
    scene = scenes.scene(scenes.ALL[name])
    kinematics = Kinematics(scene.gear)
    law = ContactLaw(scene)
    states = kinematics.states(*kinematics.ideal(scene, time_s))
    # Every ring pin's centre lies on the epitrochoid: turn the discs a little and each is inside or outside by it.
    for turn in (1e-6, -1e-6):
        off = states.copy()
        off[kinematics.layout.wheel_bodies, 2] += turn
        contacts = law.contacts(off[None])
        outer = contacts.sleeve < kinematics.layout.external_bodies.stop
        assert np.count_nonzero(outer) >= scene.gear.wheels * (scene.gear.external_sleeves // 2 - 1)
        assert contacts.penetration_m[outer].max() < 1e-6 * scene.gear.eccentricity_m * scene.gear.lobes * 1.01
    assert all(d < 1e-15 for d in law.contacts(states[None]).penetration_m)


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize("load_n_m", [22.0, -5.0])
def test_the_loaded_start_is_in_balance(name, load_n_m):
    text = EXACT[name] + f'[drive]\nstart = "equilibrium"\noutput_torque_n_m = {load_n_m}\n'
    scene = scenes.scene(text)
    kinematics = Kinematics(scene.gear)
    layout = kinematics.layout
    angles, rates = initial_angles(scene)
    # Without friction: its torque on the discs is not part of the balance.
    plain = scenes.scene(text.replace("friction_coefficient = 0.1", ""))
    still = kinematics.states(angles, 0.0 * rates)
    torques = kinematics.torques(angles, ContactLaw(plain).loads(still[None])[0])
    assert torques[1] + load_n_m == pytest.approx(0.0, abs=1e-7)
    assert np.max(np.abs(torques[layout.wheel_bodies])) < 1e-7
    assert np.all(rates == kinematics.ideal(scene)[1])


def test_given_states_are_checked():
    scene = scenes.scene()
    with pytest.raises(SceneError, match="28 bodies"):
        initial_angles(scene, np.zeros(5))
    with pytest.raises(SceneError, match="finite"):
        initial_angles(scene, np.full((28, 6), np.nan))


def test_steps_hit_every_sample():
    assert steps_between(0.0, 1e-4, 1e-5)[0] == 10
    assert steps_between(0.0, 1e-4, 1e-5)[1] == pytest.approx(1e-5)
    assert steps_between(0.3, 0.3 + 1e-4, 1e-5)[0] == 10
    assert steps_between(0.0, 1e-4, 3e-5)[0] == 4
    assert steps_between(0.0, 1e-4, 1.0)[0] == 1
    parts = stretches(scenes.scene(duration_s=2.5e-4).solver.sample_times_s(), 2e-5)
    assert [(p.samples, p.steps_a_sample) for p in parts] == [(2, 5), (1, 3)]
    assert parts[-1].end_s == 2.5e-4
    assert actual_step_s(np.array([0.0, 1e-4, 2e-4]), 3e-5) == pytest.approx(2.5e-5)
    assert stretches(np.array([0.0]), 1.0) == []
