"""Closest points against brute force, curvature against its closed forms."""

import numpy as np
import pytest

from pinwheel_engines.geometry import Epitrochoid, Moved, circle_curvature, nearest_vertex, root_between
from pinwheel_engines.law import ContactLaw
from tests import scenes

CURVES = {
    "paper": Epitrochoid(0.064, 0.7, 16),
    "eleven": Epitrochoid(0.044, 0.7, 11),
    "sharp": Epitrochoid(0.064, 0.97, 16),
    "flat": Epitrochoid(0.05, 0.05, 40),
    "three": Epitrochoid(0.02, 0.6, 3),
}


def brute_distance(curve, p):
    """Distance by sampling the full curve, then golden sections around the best sample."""
    a = np.linspace(0.0, 2.0 * np.pi, 20001)
    c = curve.point(a)
    result = []
    for z in p:
        k = int(np.argmin(np.abs(z - c)))
        low, high = a[k] - 4e-4, a[k] + 4e-4
        for _ in range(80):
            left, right = low + 0.382 * (high - low), high - 0.382 * (high - low)
            if abs(z - curve.point(np.array([left]))[0]) < abs(z - curve.point(np.array([right]))[0]):
                high = right
            else:
                low = left
        result.append(abs(z - curve.point(np.array([0.5 * (low + high)]))[0]))
    return np.array(result)


@pytest.mark.parametrize("curve", CURVES.values(), ids=CURVES)
@pytest.mark.parametrize("depth_m", [1e-7, 1e-5, 1e-3, 5e-3])
def test_closest_point_is_the_closest(curve, depth_m):
    rng = np.random.default_rng(3)
    a = rng.uniform(-np.pi, np.pi, 60)
    p = curve.point(a) - rng.uniform(0.1, 1.0, a.size) * depth_m * curve.normal(a)
    inside, polar = curve.inside(p)
    p, polar = p[inside], polar[inside]
    assert p.size > 40
    foot, signed = curve.closest(p, polar)
    assert np.all(signed < 0.0)
    # The golden section stops at the root of the rounding; its distance is right to 1e-15 m.
    np.testing.assert_allclose(-signed, brute_distance(curve, p), rtol=0, atol=2e-15)
    # The foot's normal passes through the point.
    away = (p - curve.point(foot)) * np.conj(curve.normal(foot))
    assert np.max(np.abs(away.imag)) < 1e-15


def test_inside_is_told_by_the_winding_number():
    curve = CURVES["sharp"]
    rng = np.random.default_rng(5)
    p = rng.uniform(-0.075, 0.075, 300) + 1j * rng.uniform(-0.075, 0.075, 300)
    loop = curve.point(np.linspace(0.0, 2.0 * np.pi, 8001))
    turns = np.angle((loop[None, 1:] - p[:, None]) / (loop[None, :-1] - p[:, None])).sum(axis=1)
    np.testing.assert_array_equal(curve.inside(p)[0], turns > np.pi)


def test_curvature_of_the_papers_profile():
    curve = CURVES["paper"]
    q = 0.006
    tip, pit = 1.0 / curve.curvature(np.array([0.0, np.pi / 15])) - q
    assert tip == pytest.approx(9.1607e-3, rel=1e-5)
    assert pit == pytest.approx(-6.5647e-3, rel=1e-5)
    a = np.linspace(0.0, 2.0 * np.pi, 200001)
    radius = 1.0 / curve.curvature(a)
    assert radius[radius > 0].min() - q == pytest.approx(7.1226e-3, rel=1e-5)


def test_three_point_curvature_converges_to_the_profiles():
    scene = scenes.scene('[contact]\ndetection = "points"\nwheel_points = 60000')
    law = ContactLaw(scene)
    a = 2.0 * np.pi * np.arange(60000) / 60000
    of_points = law.stiffness_factor * np.sqrt(0.006 / (1.0 + 0.006 * law._profile_curvature))
    np.testing.assert_allclose(of_points, law.profile_stiffness(a), rtol=3e-5)


def test_circle_curvature_is_signed():
    z = np.exp(np.array([0.1j, 0.2j, 0.35j])) * np.complex128(0.5)
    left = circle_curvature(z[:1], z[1:2], z[2:])
    assert left[0] == pytest.approx(2.0, rel=1e-12)
    assert circle_curvature(z[2:], z[1:2], z[:1])[0] == pytest.approx(-2.0, rel=1e-12)


def test_nearest_vertex_over_blocks():
    rng = np.random.default_rng(7)
    vertices = rng.normal(size=50) + 1j * rng.normal(size=50)
    p = rng.normal(size=33) + 1j * rng.normal(size=33)
    index, distance = nearest_vertex(p, vertices, rows_at_once=8)
    table = np.abs(p[:, None] - vertices[None, :])
    np.testing.assert_array_equal(index, table.argmin(axis=1))
    np.testing.assert_allclose(distance, table.min(axis=1), rtol=1e-15)


def test_root_where_newton_alone_would_leave():
    # atan is the classical function on which Newton runs away from a far start.
    def steep(x, _which):
        return np.arctan(40.0 * (x - 0.3)), 40.0 / (1.0 + (40.0 * (x - 0.3)) ** 2)

    x = root_between(steep, np.array([-7.0]), np.array([5.0]))
    assert x[0] == pytest.approx(0.3, abs=1e-15)


@pytest.mark.parametrize(
    "offset",
    [
        {"cos_m": [5e-6, 8e-6, 0.0, -2e-6], "sin_m": [6e-6, 1e-6]},
        {"points_m": [0.0, 9e-6, 2e-6, -5e-6, 4e-6, 1e-6, -3e-6, 6e-6]},
    ],
)
def test_a_moved_curve_is_its_points(offset):
    curve, step = Moved(0.064, 0.7, 16, offset), 1e-6
    a = np.linspace(0.0, 2.0 * np.pi, 501)
    first, second = curve._derivatives(a)
    slope = (curve.point(a + step) - curve.point(a - step)) / (2.0 * step)
    bend = (curve._derivatives(a + step)[0] - curve._derivatives(a - step)[0]) / (2.0 * step)
    assert np.max(np.abs(slope - first)) < 1e-9
    assert np.max(np.abs(bend - second)) < 1e-5
    for off in (-3e-4, 1e-6, 2e-4):
        points = curve.point(a) + off * curve.normal(a)
        inside, at = curve.inside(points)
        assert np.all(inside == (off < 0.0))
        assert np.max(np.abs(curve.closest(points, at)[1] - off)) < 1e-15


def test_a_constant_offset_is_a_parallel_curve():
    plain, moved = Epitrochoid(0.064, 0.7, 16), Moved(0.064, 0.7, 16, {"cos_m": [1e-5]})
    a = np.linspace(0.0, 2.0 * np.pi, 501)
    assert np.max(np.abs(moved.point(a) - plain.point(a) + 1e-5 * plain.normal(a))) < 1e-16
    assert np.allclose(moved.curvature(a) * (1.0 - 1e-5 * plain.curvature(a)), plain.curvature(a), rtol=1e-12)
