"""Closest points: the pin centre against the epitrochoid, against discrete points, against a hole's circle.

The epitrochoid C(a) = R e^{ia} + e e^{i zk a} (e zk = m R) is the path of the disc profile's outward offset by q,
so its signed distance to a pin's centre is minus the penetration (Eq. 1). Points of the plane are complex numbers
in the disc's frame, m; arrays are one-dimensional, one entry a point.

Method for the exact distance. C is star-shaped about the disc's centre (its polar angle grows with a for any m < 1), so
1. the parameter a_b with the point's own polar angle is the only root of a monotone function, bracketed by
   asin(e/R): it tells inside from outside, and C(a_b) gives an upper bound U of the distance;
2. every curve point nearer than U lies within asin(U/rho) of that polar angle, which bounds a;
3. in that window all sampled minima of the distance are polished by safeguarded Newton, and the least one wins.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from pinwheel_engines.scene import Gear

Floats = npt.NDArray[np.float64]
Points = npt.NDArray[np.complex128]
Ints = npt.NDArray[np.intp]
Bools = npt.NDArray[np.bool_]

# Samples per lobe pitch in the search window: the distance has at most two minima per lobe, and the sharpest feature, the
# pit, is about a fifteenth of a lobe pitch wide at m = 0.7.
SAMPLES_PER_LOBE = 96


def root_between(value_and_slope: Callable[[Floats, Ints], tuple[Floats, Floats]], low: Floats, high: Floats) -> Floats:
    """Roots of increasing-through-zero functions, one a bracket: Newton, bisection where Newton leaves the bracket.

    `value_and_slope(x, which)` gives f and f' of the functions `which` at x. f(low) <= 0 <= f(high) is assumed. Stops
    at a step below two units in the last place of max(|x|, 1), or where steps shrink so fast that the next would be: where
    f is flat its rounding moves x by more than that, for ever.
    """
    low, high = low.copy(), high.copy()
    x, before = 0.5 * (low + high), high - low
    active = np.arange(x.size)
    for _ in range(80):
        f, slope = value_and_slope(x[active], active)
        below = f < 0.0
        low[active[below]] = x[active[below]]
        high[active[~below]] = x[active[~below]]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            newton = x[active] - f / slope
        lo, hi = low[active], high[active]
        # Newton's last steps may land a rounding error outside the bracket that it has just tightened.
        slack = 4.0e-16 * np.maximum(1.0, np.abs(x[active]))
        good = (newton >= lo - slack) & (newton <= hi + slack)
        following = np.where(good, newton, 0.5 * (lo + hi))
        step = np.abs(following - x[active])
        quadratic = good & (step < 1e-9) & (step < 1e-2 * before[active])
        x[active], before[active] = following, step
        active = active[(step > slack) & ~quadratic]
        if active.size == 0:
            break
    return x


@dataclass(frozen=True)
class Epitrochoid:
    """C(a) = R e^{ia} + e e^{i zk a} with R in m, m the shortening, zk loops per turn plus one."""

    radius_m: float
    shortening: float
    external_sleeves: int

    @staticmethod
    def of(gear: Gear) -> Epitrochoid:
        """The curve of a gear's disc, with its modification."""
        curve = (gear.generating_radius_m, gear.generating_shortening, gear.external_sleeves)
        return Moved(*curve, gear.normal_m) if gear.normal_m else Epitrochoid(*curve)

    def _derivatives(self, a: Floats) -> tuple[Points, Points]:
        """C'(a) and C''(a), m."""
        m, zs, r = self.shortening, self.lobes, self.radius_m
        turn, wave = np.exp(1j * a), np.exp(1j * zs * a)
        return 1j * r * turn * (1.0 + m * wave), -r * turn * (1.0 + (zs + 1) * m * wave)

    @property
    def lobes(self) -> int:
        """zs = zk - 1."""
        return self.external_sleeves - 1

    @property
    def ratio(self) -> float:
        """e/R = m/zk."""
        return self.shortening / self.external_sleeves

    def point(self, a: Floats) -> Points:
        """C(a), m."""
        turn = np.exp(1j * a)
        return np.asarray(self.radius_m * turn * (1.0 + self.ratio * np.exp(1j * self.lobes * a)))

    def normal(self, a: Floats) -> Points:
        """Outward unit normal: the direction of e^{ia}(1 + m e^{i zs a}), angle a + gamma."""
        direction = np.exp(1j * a) * (1.0 + self.shortening * np.exp(1j * self.lobes * a))
        return np.asarray(direction / np.abs(direction))

    def curvature(self, a: Floats) -> Floats:
        """1/m, positive on a lobe, negative in a pit: (1 + zk m^2 + (zk + 1) m cos zs a)/(R |1 + m e^{i zs a}|^3)."""
        m, zk = self.shortening, self.external_sleeves
        c = np.cos(self.lobes * a)
        return np.asarray((1.0 + zk * m * m + (zk + 1) * m * c) / (self.radius_m * (1.0 + m * m + 2.0 * m * c) ** 1.5))

    def curvature_slope(self, a: Floats) -> Floats:
        """Derivative of the curvature with the parameter, 1/m.

        With c = cos zs a, N = 1 + zk m^2 + (zk + 1) m c and g = 1 + m^2 + 2 m c: kappa = N/(R g^1.5), so
        d kappa/dc = m ((zk + 1) g - 3 N)/(R g^2.5), and dc/da = -zs sin zs a.
        """
        m, zk, zs = self.shortening, self.external_sleeves, self.lobes
        c = np.cos(zs * a)
        g, n = 1.0 + m * m + 2.0 * m * c, 1.0 + zk * m * m + (zk + 1) * m * c
        return np.asarray(-zs * np.sin(zs * a) * m * ((zk + 1) * g - 3.0 * n) / (self.radius_m * g**2.5))

    def speed(self, a: Floats) -> Floats:
        """|C'(a)| = R |1 + m e^{i zs a}|, m."""
        return np.asarray(self.radius_m * np.abs(1.0 + self.shortening * np.exp(1j * self.lobes * a)))

    def parameter_at(self, polar: Floats) -> Floats:
        """The parameter a whose point C(a) has the given polar angle."""
        mu, zs = self.ratio, self.lobes
        reach = 1.000001 * math.asin(mu)

        def excess(a: Floats, which: Ints) -> tuple[Floats, Floats]:
            w = 1.0 + mu * np.exp(1j * zs * a)
            value = a + np.angle(w) - polar[which]
            slope = 1.0 + zs * mu * (np.cos(zs * a) + mu) / np.abs(w) ** 2
            return value, slope

        return root_between(excess, polar - reach, polar + reach)

    def inside(self, p: Points) -> tuple[Bools, Floats]:
        """True for each point within the curve, and the curve's parameter at the polar angle of each point."""
        a = self.parameter_at(np.angle(p))
        return np.abs(p) < np.abs(self.point(a)), a

    def closest(self, p: Points, a_polar: Floats) -> tuple[Floats, Floats]:
        """Parameter of the closest curve point and the signed distance (negative inside) of every point.

        `a_polar` is the second result of `inside`. The distance is taken along the normal, where an error of a counts
        only to second order.
        """
        if p.size == 0:
            return np.zeros(0), np.zeros(0)
        m, zs = self.shortening, self.lobes
        rho = np.abs(p)
        bound = np.abs(p - self.point(a_polar))
        # Least slope of the polar angle in a, reached in the pits.
        least = (1.0 - m) * (1.0 - self.ratio) / (1.0 + self.ratio) ** 2
        with np.errstate(divide="ignore", invalid="ignore"):
            spread = np.where(bound < rho, np.arcsin(np.minimum(1.0, bound / rho)), math.pi)
        half = np.minimum(1.01 * spread / least + 1e-9, math.pi)
        cells = int(np.ceil(np.max(half) * 2.0 / (2.0 * math.pi / zs / SAMPLES_PER_LOBE)))
        count = 2 * max(2, (cells + 1) // 2) + 1
        grid = a_polar[:, None] + half[:, None] * np.linspace(-1.0, 1.0, count)[None, :]
        distance = np.abs(p[:, None] - self.point(grid))
        left, middle, right = distance[:, :-2], distance[:, 1:-1], distance[:, 2:]
        row, column = np.nonzero((middle <= left) & (middle <= right))
        if not np.array_equal(np.unique(row), np.arange(p.size)):
            # Only in a window of a few units in the last place does rounding hide the minimum: polish its best sample.
            lost = np.setdiff1d(np.arange(p.size), row)
            row = np.concatenate([row, lost])
            column = np.concatenate([column, np.argmin(middle[lost], axis=1)])

        def slope_of_distance(a: Floats, which: Ints) -> tuple[Floats, Floats]:
            # d/da of |p - C|^2/2 = -Re(conj(p - C) C'), and its derivative.
            away = np.conj(p[row[which]] - self.point(a))
            first, second = self._derivatives(a)
            return -np.real(away * first), np.abs(first) ** 2 - np.real(away * second)

        a = root_between(slope_of_distance, grid[row, column], grid[row, column + 2])
        apart = np.abs(p[row] - self.point(a))
        # Least distance first within each point; equal ones keep the smaller parameter.
        order = np.lexsort((a, apart, row))
        first_of_row = order[np.unique(row[order], return_index=True)[1]]
        best = a[first_of_row]
        signed = np.real((p - self.point(best)) * np.conj(self.normal(best)))
        return best, signed


@dataclass(frozen=True)
class Moved(Epitrochoid):
    """C(a) - w(zs a) n(a): the curve moved along its inward normal by a series or a periodic spline."""

    offset: dict[str, list[float]]

    @cached_property
    def _waves(self) -> tuple[Floats, Floats]:
        """Values and second derivatives of w at the spline's knots, which discrete Fourier transforms decouple."""
        values = np.array(self.offset["points_m"])
        step = 2.0 * math.pi / values.size
        cos = np.cos(step * np.arange(values.size))
        bends = np.fft.ifft(np.fft.fft(values) * (2.0 * cos - 2.0) / (2.0 * cos + 4.0)).real * 6.0 / step**2
        return values, bends

    def _moved_by(self, a: Floats) -> tuple[Floats, Floats, Floats]:
        """The offset w and its first two derivatives with the parameter, m."""
        zs = self.lobes
        if self.offset.get("points_m"):
            values, bends = self._waves
            step = 2.0 * math.pi / values.size
            place = np.mod(zs * a / step, values.size)
            k = np.minimum(place.astype(int), values.size - 1)
            after, b = (k + 1) % values.size, place - k
            w0, w1, m0, m1 = values[k], values[after], bends[k] * step**2 / 6.0, bends[after] * step**2 / 6.0
            c = 1.0 - b
            value = c * w0 + b * w1 + (c**3 - c) * m0 + (b**3 - b) * m1
            slope = (w1 - w0 + (1.0 - 3.0 * c * c) * m0 + (3.0 * b * b - 1.0) * m1) / step
            return value, zs * slope, zs * zs * 6.0 * (c * m0 + b * m1) / step**2
        cos, sin = self.offset.get("cos_m", []), self.offset.get("sin_m", [])
        parts = np.zeros(max(len(cos), len(sin) + 1), dtype=complex)
        parts[: len(cos)] += cos
        parts[1 : len(sin) + 1] -= 1j * np.array(sin)
        orders = 1j * zs * np.arange(parts.size)
        waves = parts * np.exp(np.multiply.outer(a, orders))
        value, slope, bend = (np.sum(waves * orders**k, axis=-1).real for k in range(3))
        return value, slope, bend

    def _bare(self) -> Epitrochoid:
        return Epitrochoid(self.radius_m, self.shortening, self.external_sleeves)

    def _derivatives(self, a: Floats) -> tuple[Points, Points]:
        # n' = i t n with t = kappa s, so C' - (w n)' = n (i (s - w t) - w').
        w, first, second = self._moved_by(a)
        bare, m, zs = self._bare(), self.shortening, self.lobes
        n, s = bare.normal(a), bare.speed(a)
        s_slope = -(self.radius_m**2) * m * zs * np.sin(zs * a) / s
        t = bare.curvature(a) * s
        t_slope = bare.curvature_slope(a) * s + bare.curvature(a) * s_slope
        inner = 1j * (s - w * t) - first
        return n * inner, n * (1j * t * inner + 1j * (s_slope - first * t - w * t_slope) - second)

    def point(self, a: Floats) -> Points:
        """C(a) - w n, m."""
        bare = self._bare()
        return np.asarray(bare.point(a) - self._moved_by(a)[0] * bare.normal(a))

    def normal(self, a: Floats) -> Points:
        """Outward unit normal of the moved curve."""
        first, _ = self._derivatives(a)
        return np.asarray(-1j * first / np.abs(first))

    def curvature(self, a: Floats) -> Floats:
        """1/m, of the moved curve."""
        first, second = self._derivatives(a)
        return np.asarray(np.imag(np.conj(first) * second) / np.abs(first) ** 3)

    def curvature_slope(self, a: Floats) -> Floats:
        """Derivative of the curvature with the parameter, 1/m, by differences."""
        step = 1e-4 / self.lobes
        return np.asarray((self.curvature(a + step) - self.curvature(a - step)) / (2.0 * step))

    def speed(self, a: Floats) -> Floats:
        """|C'(a)|, m."""
        return np.asarray(np.abs(self._derivatives(a)[0]))

    def parameter_at(self, polar: Floats) -> Floats:
        """The parameter a whose point C(a) has the given polar angle."""
        reach = 1.2 * math.asin(self.ratio) + 0.01 / self.lobes

        def excess(a: Floats, which: Ints) -> tuple[Floats, Floats]:
            point = self.point(a)
            value = np.angle(point * np.exp(-1j * polar[which]))
            return value, np.imag(self._derivatives(a)[0] / point)

        return root_between(excess, polar - reach, polar + reach)


def circle_curvature(before: Points, here: Points, after: Points) -> Floats:
    """Signed curvature 1/m of the circle through three neighbours (Menger): 4 area/(product of the sides).

    Positive when the points turn left, which on a curve run counter-clockwise is convex. Three points on a line: 0.
    """
    a, b, c = here - before, after - here, after - before
    return np.asarray(2.0 * np.imag(np.conj(a) * b) / (np.abs(a) * np.abs(b) * np.abs(c)))


def nearest_vertex(p: Points, vertices: Points, rows_at_once: int = 512) -> tuple[Ints, Floats]:
    """Index of the nearest vertex and its distance, m, by looking at every one. Equal distances: the smaller index."""
    index = np.zeros(p.size, dtype=np.intp)
    distance = np.zeros(p.size)
    for start in range(0, p.size, rows_at_once):
        part = slice(start, start + rows_at_once)
        apart = p[part, None] - vertices[None, :]
        squared = apart.real**2 + apart.imag**2
        index[part] = np.argmin(squared, axis=1)
        distance[part] = np.abs(p[part] - vertices[index[part]])
    return index, distance
