"""The contact law against its own definitions: rates by finite differences, balance, hand calculations, convergence."""

import csv
import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from pinwheel_engines import ContactLaw, SceneError, Unsupported, evaluate
from pinwheel_engines.layout import Kinematics
from pinwheel_engines.line_hertz import LineHertz, disc_depth_m, wall_m
from tests import scenes

VECTORS = Path(__file__).parents[2] / "reference/law-vectors"


def vectors(file, case):
    """Columns of the rows of a case."""
    with (VECTORS / file).open(encoding="utf-8", newline="") as text:
        rows = [row for row in csv.DictReader(text) if row["case"] == case]
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0] if key != "case"}


@pytest.mark.parametrize("name", scenes.ALL)
def test_forces_and_moments_balance(name):
    scene = scenes.scene(scenes.ALL[name])
    states = scenes.random_states(scene, 200)
    loads = evaluate(scene, states)
    total = loads[..., :2].sum(axis=1)
    moment = (loads[..., 2] + states[..., 0] * loads[..., 1] - states[..., 1] * loads[..., 0]).sum(axis=1)
    size = np.abs(loads[..., :2]).sum(axis=(1, 2))
    assert size.max() > 10.0
    # Sums over 28 bodies of numbers with 1e-16 each; levers are below 0.1 m.
    assert np.max(np.abs(total)) < 1e-14 * size.max()
    assert np.max(np.abs(moment)) < 1e-15 * size.max()
    # Shafts are not touched.
    assert np.all(loads[:, :2] == 0.0)


@pytest.mark.parametrize("name", ["paper", "backlash", "points", "eleven", "one-wheel", "line"])
def test_normal_rate_is_the_rate_of_penetration(name):
    scene = scenes.scene(scenes.ALL[name])
    law = ContactLaw(scene)
    states = scenes.random_states(scene, 40, seed=2)
    h = 1e-7
    before, after = states.copy(), states.copy()
    before[..., :3] -= h * states[..., 3:]
    after[..., :3] += h * states[..., 3:]
    here, there, then = law.contacts(states), law.contacts(before), law.contacts(after)
    key = [dict(zip(zip(c.state, c.wheel, c.sleeve, strict=True), c.penetration_m, strict=True)) for c in (there, then)]
    compared = 0
    for k in range(here.state.size):
        pair = (here.state[k], here.wheel[k], here.sleeve[k])
        if pair in key[0] and pair in key[1]:
            rate = (key[1][pair] - key[0][pair]) / (2.0 * h)
            # Difference quotient: rounding 1e-17/1e-7 m/s; curvature of the path h |a| ~ 1e-7 m/s. With points the
            # nearest vertex may change within h, which is rare and skipped by the penetration's kink being small.
            assert rate == pytest.approx(here.normal_rate_m_s[k], abs=3e-6 if not law.points else 2e-4)
            compared += 1
    assert compared > 300 if name not in ("backlash", "one-wheel") else compared > 100


def test_internal_contact_by_hand():
    # Disc 0 turned by t from the ideal mesh about its centre: hole k moves by R_w t along its tangent.
    scene = scenes.scene()
    kinematics = Kinematics(scene.gear)
    layout = kinematics.layout
    angles, rates = kinematics.ideal(scene)
    angles[2] += 1e-3
    contacts = ContactLaw(scene).contacts(kinematics.states(angles, rates)[None])
    inner = (contacts.wheel == 2) & (contacts.sleeve >= layout.internal_bodies.start)
    k = contacts.sleeve[inner] - layout.internal_bodies.start
    turn = 2.0 * math.pi * k / 8
    # Pin against hole: -e along x (phase 0) and minus the hole's displacement.
    away = -0.0028 - 0.038 * np.exp(1j * turn) * (np.exp(1e-3j) - 1.0)
    np.testing.assert_allclose(contacts.penetration_m[inner], np.abs(away) - 0.0028, rtol=1e-9)
    delta = contacts.penetration_m[inner]
    stiffness = 4.0 * 0.01 / (3.0 * 2.0 * (1 - 0.09) / 2e11) * math.sqrt(0.0088 * 0.006 / 0.0028)
    np.testing.assert_allclose(contacts.stiffness[inner], stiffness, rtol=1e-14)
    expected = np.minimum(delta / 1e-5, 1.0) * (stiffness * delta**1.5 + 8.0 * contacts.normal_rate_m_s[inner])
    np.testing.assert_allclose(contacts.normal_force_n[inner], np.maximum(0.0, expected), rtol=1e-12)


def test_contacts_never_pull():
    scene = scenes.scene("[contact]\ndamping_n_s_m = 1000.0")
    contacts = ContactLaw(scene).contacts(scenes.random_states(scene, 50))
    assert np.any(contacts.normal_rate_m_s < -0.01)
    assert np.all(contacts.normal_force_n >= 0.0)
    assert np.any(contacts.normal_force_n == 0.0)


def test_friction_opposes_sliding_in_both_directions():
    scene = scenes.scene(scenes.FRICTION)
    contacts = ContactLaw(scene).contacts(scenes.random_states(scene, 50))
    loaded = contacts.normal_force_n > 0.0
    v, f, n = contacts.tangential_rate_m_s[loaded], contacts.friction_force_n[loaded], contacts.normal_force_n[loaded]
    assert np.any(v > 1e-3)
    assert np.any(v < -1e-3)
    assert np.all(f * v <= 0.0)
    sliding = np.abs(v) > 5e-5
    np.testing.assert_allclose(np.abs(f[sliding]), 0.1 * n[sliding], rtol=1e-14)


def test_the_sleeves_spin_counts():
    scene = scenes.scene(scenes.FRICTION)
    states = scenes.random_states(scene, 5)
    spun = states.copy()
    spun[:, 4:, 5] += 2.0
    law = ContactLaw(scene)
    a, b = law.contacts(states), law.contacts(spun)
    np.testing.assert_array_equal(a.sleeve, b.sleeve)
    # W is a radius less the penetration away from the pin's centre, along n.
    np.testing.assert_allclose(b.tangential_rate_m_s - a.tangential_rate_m_s, 2.0 * (0.006 - a.penetration_m), rtol=1e-9)
    np.testing.assert_allclose(b.normal_rate_m_s, a.normal_rate_m_s, atol=1e-15)


@pytest.mark.parametrize("name", scenes.ALL)
def test_a_batch_gives_the_bits_of_single_states(name):
    scene = scenes.scene(scenes.ALL[name])
    states = scenes.random_states(scene, 7)
    law = ContactLaw(scene)
    together = law.loads(states)
    assert np.array_equal(together, law.loads(states))
    for i in range(7):
        # The search window's sampling depends on the batch, the polished foot only to rounding.
        np.testing.assert_allclose(law.loads(states[i : i + 1])[0], together[i], rtol=0, atol=1e-10)


@pytest.mark.parametrize("name", ["paper", "friction", "backlash", "eleven", "one-wheel", "line"])
def test_rounding_stays_within_its_bound(name):
    scene = scenes.scene(scenes.ALL[name])
    law = ContactLaw(scene)
    states = scenes.random_states(scene, 300)
    bound = law.rounding_n(states)
    nudged = states.copy()
    # Another place on the plane and another zero of the angle: the same mechanism with other roundings.
    turn = np.exp(0.7j)
    for x, y in ((0, 1), (3, 4)):
        z = (states[..., x] + 1j * states[..., y]) * turn
        nudged[..., x], nudged[..., y] = z.real, z.imag
    nudged[..., 2] += 0.7
    there, here = law.loads(nudged), law.loads(states)
    force = (there[..., 0] + 1j * there[..., 1]) / turn - (here[..., 0] + 1j * here[..., 1])
    worst = np.abs(force).max(axis=1)
    assert bound.max() > 0.0
    # Measured 0.24 to 0.94, and rounding is not idle.
    assert np.max(worst / (bound + 1e-15)) < 3.0
    assert np.max(worst / (bound + 1e-15)) > 0.1


def test_batches_of_any_size():
    scene = scenes.scene()
    assert evaluate(scene, np.zeros((0, 28, 6))).shape == (0, 28, 3)
    states = scenes.random_states(scene, 3)
    many = np.repeat(states, 400, axis=0)
    np.testing.assert_allclose(evaluate(scene, many)[::400], evaluate(scene, states), rtol=0, atol=1e-10)


def test_points_converge_to_the_exact_contact():
    exact = scenes.scene()
    states = scenes.random_states(exact, 25)
    wanted = evaluate(exact, states)[..., :2]
    errors = []
    for count in (500, 2000, 8000):
        points = exact.with_keys("contact", detection="points", wheel_points=count, hole_points=count)
        computed = evaluate(points, states)[..., :2]
        errors.append(np.sqrt(np.mean((computed - wanted) ** 2) / np.mean(wanted**2)))
    # The normal's direction is off by up to half a spacing over the pin's radius: first order.
    assert errors[0] > 2.5 * errors[1] > 6.0 * errors[2]
    assert errors[2] < 0.02


def test_points_without_a_stiffness_are_refused(monkeypatch):
    # No profile tried makes such a pit; the guard stands against a square root of a negative number all the same.
    monkeypatch.setattr("pinwheel_engines.law.circle_curvature", lambda before, *_: np.full(before.size, -200.0))
    with pytest.raises(SceneError, match="wheel_points"):
        ContactLaw(scenes.scene(scenes.POINTS))


@pytest.mark.parametrize(
    "text",
    ['[contact]\nlaw = "hunt-crossley"', '[contact]\nfriction_law = "adams"\nfriction_coefficient = 0.1'],
)
def test_other_laws_are_refused(text):
    with pytest.raises(Unsupported, match="knows only"):
        ContactLaw(scenes.scene(text))


def test_known_laws_are_listed():
    with pytest.raises(Unsupported, match="knows only paper, line-hertz; run it by the Pinwheel program"):
        ContactLaw(scenes.scene('[contact]\nlaw = "constant"'))


def test_line_contacts_at_points_are_refused():
    with pytest.raises(Unsupported, match="exact"):
        ContactLaw(scenes.scene(scenes.POINTS + 'law = "line-hertz"\n'))


@pytest.mark.parametrize("law", ["paper", "line-hertz"])
def test_the_published_vectors(law):
    # Forces, forces along the profile and loads of the library, at the states that it publishes.
    scene = scenes.scene(f'[contact]\nlaw = "{law}"')
    bodies, wanted = vectors("bodies.csv", f"law-{law}"), vectors("contacts.csv", f"law-{law}")
    columns = ("x_m", "y_m", "angle_rad", "vx_m_s", "vy_m_s", "rate_rad_s")
    states = np.stack([bodies[name] for name in columns], axis=-1)[None]
    numpy_law = ContactLaw(scene)
    pairs = numpy_law.contacts(states)
    np.testing.assert_array_equal(pairs.wheel - 2, wanted["wheel"])
    np.testing.assert_array_equal(pairs.sleeve, wanted["sleeve_body"])
    largest = np.abs(wanted["normal_force_n"]).max()
    # Measured 4.2e-12 at most: penetrations are known to 1.4e-17 m.
    assert np.abs(pairs.normal_force_n - wanted["normal_force_n"]).max() < 1e-11 * largest
    assert np.abs(pairs.friction_force_n - wanted["friction_force_n"]).max() < 1e-11 * largest
    along = np.abs(wanted["along_force_n"]).max()
    assert (along > 5e-4 * largest) == (law == "line-hertz")
    assert np.abs(pairs.along_force_n - wanted["along_force_n"]).max() <= 1e-11 * along
    np.testing.assert_allclose(pairs.stiffness, wanted["stiffness_n_m15"], rtol=1e-12)
    loads = numpy_law.loads(states)[0]
    for column, name in enumerate(("force_x_n", "force_y_n", "moment_n_m")):
        assert np.abs(loads[:, column] - bodies[name]).max() < 1e-11 * np.abs(bodies[name]).max()


@pytest.mark.parametrize("text", ["", scenes.MODIFIED, scenes.ERRORS])
def test_line_forces_come_from_an_energy(text):
    # The force field over the places of one pin, the rest held, has no curl: dFx/dy = dFy/dx.
    scene = scenes.scene(text).with_keys("contact", law="line-hertz", pin_young_pa=5e10, damping_n_s_m=0.0)
    law, h, curls = ContactLaw(scene), 1e-9, []
    for state in scenes.random_states(scene, 6, seed=3, spread_rad=1e-3):
        here = law.contacts(state[None])
        for sleeve in np.unique(here.sleeve[here.sleeve < law.layout.internal_bodies.start]):
            if here.penetration_m[here.sleeve == sleeve].min() < 1e-5:
                continue
            moved = np.repeat(state[None], 4, axis=0)
            for row, (axis, way) in enumerate(((0, h), (0, -h), (1, h), (1, -h))):
                moved[row, sleeve, axis] += way
            force = law.loads(moved)[:, sleeve, :2]
            by_x, by_y = (force[0] - force[1]) / (2.0 * h), (force[2] - force[3]) / (2.0 * h)
            curls.append((by_y[0] - by_x[1]) / max(np.abs(by_x).max(), np.abs(by_y).max()))
    assert len(curls) > 5
    # Measured 1.3e-8, which is rounding; 1e-2 without the force along the profile, twice that with its sign turned.
    assert np.abs(curls).max() < 1e-7


def test_line_contacts_follow_the_approach():
    # The force computed from a depth gives that depth as approach, up to where the contact becomes a linear spring.
    line = LineHertz(3e-8, 5e-8, 0.3, 0.01)
    radius, sleeve = np.full(40, 0.02), np.full(40, 0.006)
    depth = np.geomspace(1e-12, 2e-4, 40)
    force, slope = line.force_and_slope(depth, radius, sleeve)
    approach = line.approach_m(force, radius, sleeve)
    np.testing.assert_allclose(approach, depth, rtol=1e-14)
    h = 1e-5
    more, less = (line.force_and_slope(depth * by, radius, sleeve)[0] for by in (1.0 + h, 1.0 - h))
    np.testing.assert_allclose((more - less) / (2.0 * h * depth), slope, rtol=1e-8)
    deep, secant = line.force_and_slope(np.array([1.0, 2.0]), radius[:2], sleeve[:2])
    assert deep[1] == pytest.approx(2.0 * deep[0], rel=1e-14)
    np.testing.assert_allclose(secant, deep[0], rtol=1e-14)


def test_wall_of_the_paper():
    # The thinnest place of 16 holes among 15 lobes, by looking at the edge everywhere.
    scene = scenes.scene()
    law = ContactLaw(scene)
    a = np.linspace(0.0, 2.0 * math.pi, 400_001)
    edge = law.curve.point(a) - scene.gear.edge_offset_m * law.curve.normal(a)
    apart = min(np.abs(edge - centre).min() for centre in law._holes.ravel())
    assert wall_m(scene.gear) == pytest.approx(apart - scene.gear.hole_radius_m, abs=1e-9)


def test_the_wall_is_the_depth_where_a_scene_has_none():
    plain = scenes.scene('[contact]\nlaw = "line-hertz"')
    states = scenes.random_states(plain, 5)
    loads = evaluate(plain, states)
    assert np.array_equal(loads, evaluate(plain.with_keys("contact", disc_depth_m=wall_m(plain.gear)), states))
    # A deeper disc gives way by more.
    deeper = evaluate(plain.with_keys("contact", disc_depth_m=0.02, damping_n_s_m=0.0), states)
    still = evaluate(plain.with_keys("contact", damping_n_s_m=0.0), states)
    assert 0.8 < np.abs(deeper).max() / np.abs(still).max() < 0.95
    # Holes that leave the disc leave half a pin's radius.
    leaving = plain.with_keys("gear", internal_circle_radius_m=0.06)
    assert disc_depth_m(leaving.gear, leaving.contact) == 0.003


def test_pins_of_another_material():
    # Steel discs on pins half as stiff: h_c + h_p is three halves of what it was.
    steel = ContactLaw(scenes.scene())
    soft = ContactLaw(scenes.scene("[contact]\npin_young_pa = 1e11\npin_poisson = 0.3"))
    assert soft.stiffness_factor == pytest.approx(steel.stiffness_factor / 1.5, rel=1e-15)
    assert soft.hole_stiffness == pytest.approx(steel.hole_stiffness / 1.5, rel=1e-15)


def test_internal_contacts_of_another_stiffness():
    text = "[contact]\ndamping_n_s_m = 0.0\n"
    one, other = scenes.scene(text), scenes.scene(text + "internal_stiffness_multiplier = 0.03\n")
    both = scenes.scene(text + "stiffness_multiplier = 0.03\n")
    states = scenes.random_states(one, 5)
    a, b, c = (ContactLaw(scene).contacts(states) for scene in (one, other, both))
    inner = a.sleeve >= ContactLaw(one).layout.internal_bodies.start
    np.testing.assert_array_equal(b.normal_force_n, np.where(inner, c.normal_force_n, a.normal_force_n))
    np.testing.assert_array_equal(b.stiffness, np.where(inner, c.stiffness, a.stiffness))
    assert ContactLaw(other).hole_stiffness == pytest.approx(3.0 * ContactLaw(one).hole_stiffness, rel=1e-15)
    # It is of balls; rollers have one H.
    one, other = (scene.with_keys("contact", law="line-hertz") for scene in (one, other))
    assert np.array_equal(evaluate(one, states), evaluate(other, states))


@pytest.mark.parametrize("law", ["paper", "line-hertz"])
def test_a_pin_that_bends_is_a_spring_in_series(law):
    """Contact and pin carry one force and share the approach; the contact's share of the rate causes the loss."""
    rigid = scenes.scene().with_keys("contact", law=law, damping_n_s_m=0.0)
    soft, pin = dataclasses.replace(rigid, pin_n_m=2e6), 2e6
    states = scenes.random_states(rigid, 200)
    a, b = ContactLaw(rigid).contacts(states), ContactLaw(soft).contacts(states)
    inner = b.sleeve >= ContactLaw(soft).layout.internal_bodies.start
    assert inner.any() and np.array_equal(a.normal_force_n[~inner], b.normal_force_n[~inner])
    force, depth = b.normal_force_n[inner], b.penetration_m[inner] - b.normal_force_n[inner] / pin
    assert np.all(force < a.normal_force_n[inner])
    plain = ContactLaw(rigid)
    radius = (b.stiffness[inner] / plain.hole_stiffness_factor) ** 2
    sleeve = np.full(depth.size, rigid.gear.internal_sleeve_radius_m)
    at_rest, _ = plain._at_rest(depth, b.stiffness[inner], radius, sleeve)
    np.testing.assert_allclose(at_rest, force, rtol=1e-9)
    damped = ContactLaw(soft.with_keys("contact", damping_n_s_m=1.0)).contacts(states)
    share = depth / b.penetration_m[inner]
    more = np.clip(depth / rigid.contact.ramp_m, 0.0, 1.0) * share**2 * damped.normal_rate_m_s[inner]
    pressed = damped.normal_force_n[inner] > (1.0 - 0.9 * share) * force
    np.testing.assert_allclose((damped.normal_force_n[inner] - force)[pressed], more[pressed], rtol=1e-6, atol=1e-9)
