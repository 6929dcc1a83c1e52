"""The contact law (Eq. 10-24), written a second time from the equations alone, over arrays of states.

A pair is a pin (centre P, radius r_s) and a disc; W is the disc's point closest to P.
    n = (W - P)/|W - P|, t = R90 n                              Eq. 10-12
    delta = r_s - |W - P|; pairs with delta <= 0 do nothing
    v_rel = (pin's material velocity at W) - (disc's), v_n = v_rel . n = d(delta)/dt, v_t = v_rel . t   Eq. 14-19
    K = 4 H/(3 pi (h_c + h_p)) sqrt(R_c R_p/(R_c + R_p)), h = (1 - nu^2)/(pi E), R_c signed                 Eq. 23, 24
    F_n = max(0, S(delta) (K delta^1.5 + C v_n)), S(x) = clamp(x/ramp, 0, 1)                                Eq. 20, 22
    F_t = -mu F_n clamp(v_t/v_s, -1, 1) along t on the pin                                               Eq. 21, 22
Both forces act at W on both bodies, so a pair balances in force and moment.

The law `line-hertz` has F_n = max(0, F + S(delta) C v_n) with F of `line_hertz`, and a third force: A = -dU/dR dR/ds along t
on the pin, where s is the way of P along t. It acts at P on both bodies. Points know no dR/ds: they are for `paper`.

A pin that bends (k, N/m) takes its part of an output pin's delta: the contact takes x, F_e(x) = k (delta - x) at rest,
and closes at s v_n, s = x/delta; F_n = F_e + s (F_n(x, s v_n) - F_e).

Four slips of the printed equations are put right: n's rate of change (Eq. 16, 17) is not taken from an un-normalised
velocity, friction acts against sliding in both directions (Eq. 22 gives none for v_t < 0), the sleeve's spin counts in
v_rel, and the contact never pulls.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import SceneError, Unsupported
from pinwheel_engines.geometry import Epitrochoid, circle_curvature, nearest_vertex
from pinwheel_engines.layout import Layout, hole_centres, turns
from pinwheel_engines.line_hertz import LineHertz, disc_depth_m
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]
Points = npt.NDArray[np.complex128]
Ints = npt.NDArray[np.intp]

# W, n, delta, R and dR/ds of touches, R = R_c R_p/(R_c + R_p).
Touch = tuple[Points, Points, Floats, Floats, Floats]
# State, disc and pin of pairs, and their touches.
Pairs = tuple[Ints, Ints, Ints, Points, Points, Floats, Floats, Floats]

LAWS = ("paper", "line-hertz")
# Remedy for every other law.
PROGRAM = "run it by the Pinwheel program, whose compiled library has all laws"

# States handled at once: keeps the scratch arrays of points detection within some 100 MB.
STATES_AT_ONCE = 1024


@dataclass(frozen=True)
class Contacts:
    """All touching pairs of a batch of states, one entry a pair, in the order state, disc, pin.

    Bodies are indices of the layout; points and directions are complex numbers in the ground frame; forces as in the
    module's equations, so the pin takes `-normal_force n + friction t` at the point and `along t` at its centre, the
    disc their opposites at the same places.
    """

    state: Ints
    wheel: Ints
    sleeve: Ints
    point_m: Points
    normal: Points
    penetration_m: Floats
    normal_rate_m_s: Floats
    tangential_rate_m_s: Floats
    stiffness: Floats
    normal_force_n: Floats
    friction_force_n: Floats
    along_force_n: Floats
    slope_n_m: Floats
    """Derivative of the normal force with the penetration at rest, N/m."""

    @property
    def force_on_sleeve_n(self) -> Points:
        """Force on the pin at the point, ground frame, N."""
        return self.normal * (-self.normal_force_n + 1j * self.friction_force_n)

    @property
    def force_on_centre_n(self) -> Points:
        """Force on the pin at its centre, ground frame, N."""
        return 1j * self.normal * self.along_force_n


class ContactLaw:
    """The contact forces of one scene. Keeps no history: the same states give the same bits."""

    def __init__(self, scene: Scene) -> None:
        """Raises Unsupported for a law without a numpy version, SceneError for points too coarse to have a stiffness."""
        contact, gear = scene.contact, scene.gear
        if contact.law not in LAWS:
            raise Unsupported(
                "the numpy contact law", f'contact.law = "{contact.law}"; it knows only {", ".join(LAWS)}; {PROGRAM}'
            )
        if contact.law != "paper" and contact.detection == "points":
            raise Unsupported(
                "the numpy contact law",
                f'contact.detection = "points" with contact.law = "{contact.law}", whose force along the profile needs the '
                'slope of the curvature; use contact.detection = "exact"',
            )
        if contact.friction_law != "regularised" and contact.friction_coefficient > 0.0:
            raise Unsupported(
                "the numpy contact law",
                f'contact.friction_law = "{contact.friction_law}"; it knows only "regularised"; {PROGRAM}',
            )
        self.scene = scene
        self.layout = Layout.of(gear)
        self.curve = Epitrochoid.of(gear)
        # Eq. 23 and 24: K/sqrt(R) of the profile and of the holes, which balls may have apart.
        compliance = (1.0 - contact.poisson**2) / (math.pi * contact.young_pa)
        compliance += (1.0 - contact.pin_poisson**2) / (math.pi * contact.pin_young_pa)
        self.stiffness_factor: float = 4.0 * contact.stiffness_multiplier / (3.0 * math.pi * compliance)
        internal = contact.internal_stiffness_multiplier if contact.law == "paper" else contact.stiffness_multiplier
        self.hole_stiffness_factor: float = 4.0 * internal / (3.0 * math.pi * compliance)
        hole_radius = _radius_in_hole(gear.hole_radius_m, gear.internal_sleeve_radius_m)
        self.hole_stiffness = self.hole_stiffness_factor * math.sqrt(hole_radius)
        self._line = LineHertz.of(contact, disc_depth_m(gear, contact)) if contact.law == "line-hertz" else None
        self._holes = hole_centres(gear)
        self._hole_radii = gear.hole_radius_m + gear.errors("hole_radius_m", self._holes.size).reshape(self._holes.shape)
        self._outer_radii = gear.external_sleeve_radius_m + gear.errors("external_sleeve_radius_m", gear.external_sleeves)
        self._inner_radii = gear.internal_sleeve_radius_m + gear.errors("internal_sleeve_radius_m", gear.internal_sleeves)
        # A disc with turned flanks is what two discs turned by these have in common.
        turn = gear.rotational_rad
        self._flanks = [np.exp(1j * turn), np.exp(-1j * turn)] if turn else [complex(1.0)]
        self._corner_parameters = np.array(self._corners()) if turn else np.zeros(2)
        layout = self.layout
        wheels = np.arange(layout.wheel_bodies.start, layout.wheel_bodies.stop)
        outer = np.arange(layout.external_bodies.start, layout.external_bodies.stop)
        inner = np.arange(layout.internal_bodies.start, layout.internal_bodies.stop)
        self._outer = np.meshgrid(wheels, outer, indexing="ij")
        self._inner = np.meshgrid(wheels, inner, indexing="ij")
        self._stiffness_rounding = 0.0
        self.points = contact.detection == "points"
        if self.points:
            self._set_up_points()

    def _set_up_points(self) -> None:
        contact, gear, curve = self.scene.contact, self.scene.gear, self.curve
        count = contact.wheel_points
        a = 2.0 * math.pi * np.arange(count) / count
        self._profile = curve.point(a) - gear.edge_offset_m * curve.normal(a)
        curvature = circle_curvature(np.roll(self._profile, 1), self._profile, np.roll(self._profile, -1))
        self._profile_curvature = curvature
        # R_c R_p/(R_c + R_p) in terms of 1/R_c: no singularity where the profile turns from lobe to pit.
        softness = 1.0 + self._outer_radii.max() * curvature
        if np.any(softness <= 0.0):
            raise SceneError(
                f"`contact.wheel_points` = {count} is too coarse: three neighbouring points make a pit that is narrower "
                "than the pin; take more points"
            )
        # A circle through points a spacing s apart has a curvature known to 2 ulp/s^2: the finer the points, the less.
        spacing = np.abs(np.roll(self._profile, -1) - self._profile)
        curvature_rounding = 4.0 * np.spacing(gear.pitch_radius_m) / spacing**2
        self._stiffness_rounding = float(np.max(0.5 * gear.external_sleeve_radius_m * curvature_rounding / softness))
        self._rim = turns(contact.hole_points)

    def profile_radius(self, a: Floats, radius: Floats | None = None) -> Floats:
        """R at the profile's parameter a, m, of a pin of that radius (m), by default the nominal one.

        With R_c = 1/kappa_C - q': R_c R_p/(R_c + R_p) = r (1 - q' kappa_C)/(1 + (r - q') kappa_C).
        """
        gear, kappa = self.scene.gear, self.curve.curvature(a)
        r, q = gear.external_sleeve_radius_m if radius is None else radius, gear.edge_offset_m
        return np.asarray(r * (1.0 - q * kappa) / (1.0 + (r - q) * kappa))

    def profile_stiffness(self, a: Floats, radius: Floats | None = None) -> Floats:
        """K there, N/m^1.5."""
        return np.asarray(self.stiffness_factor * np.sqrt(self.profile_radius(a, radius)))

    def _profile_radius_slope(self, a: Floats, radius: Floats, signed: Floats) -> Floats:
        """dR/ds of pins whose centres lie `signed` (m) outside of the curve; no unit.

        dR/d kappa = -(r/(1 + (r - q') kappa))^2. With da the centre moves by |C'| (1 + signed kappa) along the curve, and
        t = R90 n, n = -outward, points against it.
        """
        kappa, q = self.curve.curvature(a), self.scene.gear.edge_offset_m
        by_kappa = -((radius / (1.0 + (radius - q) * kappa)) ** 2)
        return np.asarray(-by_kappa * self.curve.curvature_slope(a) / (self.curve.speed(a) * (1.0 + signed * kappa)))

    def contacts(self, states: Floats) -> Contacts:
        """The touching pairs of states (n, bodies, 6)."""
        outer = self._touching_profile(states)
        inner = self._touching_holes(states)
        state, wheel, sleeve, point, normal, delta, effective, effective_slope = (
            np.concatenate(pair) for pair in zip(outer, inner, strict=True)
        )
        order = np.lexsort((sleeve, wheel, state))
        state, wheel, sleeve, point, normal = state[order], wheel[order], sleeve[order], point[order], normal[order]
        delta, effective, effective_slope = delta[order], effective[order], effective_slope[order]
        v_rel = velocity_at(states[state, sleeve], point) - velocity_at(states[state, wheel], point)
        relative = v_rel * np.conj(normal)
        v_n, v_t = relative.real, relative.imag
        contact = self.scene.contact
        in_hole = sleeve >= self.layout.internal_bodies.start
        stiffness = np.where(in_hole, self.hole_stiffness_factor, self.stiffness_factor) * np.sqrt(effective)
        own = np.concatenate([self._outer_radii, self._inner_radii])[sleeve - self.layout.external_bodies.start]
        pin = self.scene.pin_n_m
        depth = delta.copy()
        if pin is not None:
            depth[in_hole] = self._on_pins(delta[in_hole], stiffness[in_hole], effective[in_hole], own[in_hole], pin)
        share = depth / delta
        at_rest, slope = self._at_rest(depth, stiffness, effective, own)
        ramp = np.clip(depth / contact.ramp_m, 0.0, 1.0)
        normal_force = np.maximum(0.0, at_rest + ramp * contact.damping_n_s_m * share * v_n)
        if pin is not None:
            normal_force = at_rest + share * (normal_force - at_rest)
            slope = np.where(in_hole, slope * pin / (slope + pin), slope)
        along = np.zeros_like(delta)
        if self._line is not None:
            along = self._line.along_n(at_rest, effective, effective_slope)
        slide = np.clip(v_t / contact.friction_ramp_m_s, -1.0, 1.0)
        friction = -contact.friction_coefficient * normal_force * slide
        return Contacts(
            state, wheel, sleeve, point, normal, delta, v_n, v_t, stiffness, normal_force, friction, along, slope
        )

    def _at_rest(self, depth: Floats, stiffness: Floats, effective: Floats, own: Floats) -> tuple[Floats, Floats]:
        """F_e of contacts that are pressed in so deep, N, and its slope, N/m."""
        if self._line is not None:
            return self._line.force_and_slope(depth, effective, own)
        width, elastic = self.scene.contact.ramp_m, stiffness * depth**1.5
        above = 1.5 * stiffness * np.sqrt(depth)
        slope = np.where(depth < width, 2.5 * elastic / width, above)
        return np.clip(depth / width, 0.0, 1.0) * elastic, slope

    def _on_pins(self, delta: Floats, stiffness: Floats, effective: Floats, own: Floats, pin: float) -> Floats:
        """Contacts' part of delta, m, the rest being the pins' deflection: Newton's method within a shrinking bracket."""
        low, high, x = np.zeros_like(delta), delta.copy(), delta.copy()
        for _ in range(100):
            force, slope = self._at_rest(x, stiffness, effective, own)
            excess = force - pin * (delta - x)
            low, high = np.where(excess < 0.0, x, low), np.where(excess < 0.0, high, x)
            step = x - excess / (slope + pin)
            beyond = np.where((step > low) & (step < high), step, 0.5 * (low + high))
            if np.all(np.abs(beyond - x) <= 1e-15 * delta):
                break
            x = beyond
        return x

    def loads(self, states: Floats) -> Floats:
        """Loads (n, bodies, 3) = fx, fy, moment about the centre of mass, of states (n, bodies, 6)."""
        states = np.asarray(states, dtype=np.float64)
        loads = np.zeros((*states.shape[:2], 3))
        for start in range(0, states.shape[0], STATES_AT_ONCE):
            part = slice(start, start + STATES_AT_ONCE)
            self._add_loads(states[part], loads[part])
        return loads

    def rounding_n(self, states: Floats) -> Floats:
        """Bound of the difference of two correct evaluations by rounding alone, N, one number a state (n,).

        A penetration is the difference of lengths of about the pitch radius, so it is known to their unit in the last place
        (1.4e-17 m), however small it is itself; the normal force follows with its slope. Friction below its ramp follows the
        sliding rate, a difference of speeds of up to R times the greatest rate, in the same way. With points detection the
        stiffness follows a curvature through three of them. A force along the profile goes with the square of the force at
        rest, which rises by at most 1.4 shares as the penetration does by one. Two implementations that differ by more than
        a few of these do not compute the same law.
        """
        states = np.asarray(states, dtype=np.float64)
        bound = np.zeros(states.shape[0])
        contact, reach = self.scene.contact, self.scene.gear.pitch_radius_m + self.scene.gear.eccentricity_m
        for start in range(0, states.shape[0], STATES_AT_ONCE):
            part = states[start : start + STATES_AT_ONCE]
            pairs = self.contacts(part)
            delta, damping = pairs.penetration_m, contact.damping_n_s_m * np.abs(pairs.normal_rate_m_s)
            length = np.spacing(reach) * (pairs.slope_n_m + np.where(delta < contact.ramp_m, damping / contact.ramp_m, 0.0))
            speed = np.spacing(reach * np.max(np.abs(part[..., 5]), axis=1))[pairs.state]
            friction = contact.friction_coefficient * pairs.normal_force_n / contact.friction_ramp_m_s
            force = length * (1.0 + contact.friction_coefficient) + speed * (friction + contact.damping_n_s_m)
            force += self._stiffness_rounding * pairs.normal_force_n
            force += np.spacing(reach) * 2.8 * np.abs(pairs.along_force_n) / delta
            bound[start : start + STATES_AT_ONCE] = np.bincount(pairs.state, force, part.shape[0])
        return bound

    def nearest_gap_m(self, state: Floats) -> float:
        """Points detection: how much nearer the nearest point is than the next one, m, at the closest call of one state."""
        gaps = [np.inf]
        _, _, outer, local, _ = self._sleeves_in_wheel_frame(state[None], *self._outer)
        _, wheel, sleeve, inner, _ = self._sleeves_in_wheel_frame(state[None], *self._inner)
        hole, sleeve = wheel - self.layout.wheel_bodies.start, sleeve - self.layout.internal_bodies.start
        inner -= self._holes[hole, sleeve]
        outer_radii = self._outer_radii[outer - self.layout.external_bodies.start]
        rims = self._hole_radii[hole, sleeve][:, None] * self._rim[None, :]
        edges = [(local * np.conj(flank), self._profile[None, :], outer_radii) for flank in self._flanks]
        for centres, points, radius in (*edges, (inner, rims, self._inner_radii[sleeve])):
            two = np.partition(np.abs(centres[:, None] - points), 1, axis=1)[:, :2]
            touching = two[:, 0] < radius
            gaps.extend((two[touching, 1] - two[touching, 0]).tolist())
        return float(min(gaps))

    def _add_loads(self, states: Floats, loads: Floats) -> None:
        pairs = self.contacts(states)
        at_point, at_centre = pairs.force_on_sleeve_n, pairs.force_on_centre_n
        count, bodies = states.shape[0], states.shape[1]
        middle = states[pairs.state, pairs.sleeve, 0] + 1j * states[pairs.state, pairs.sleeve, 1]
        for body, sign in ((pairs.sleeve, 1.0), (pairs.wheel, -1.0)):
            centre = states[pairs.state, body, 0] + 1j * states[pairs.state, body, 1]
            moment = sign * np.imag(np.conj(pairs.point_m - centre) * at_point + np.conj(middle - centre) * at_centre)
            acting = sign * (at_point + at_centre)
            slot = pairs.state * bodies + body
            for column, value in enumerate((acting.real, acting.imag, moment)):
                loads[:, :, column] += np.bincount(slot, value, count * bodies).reshape(count, bodies)

    def _touching_profile(self, states: Floats) -> Pairs:
        """Ring pins against the discs' profiles."""
        state, wheel, sleeve, local, turn = self._sleeves_in_wheel_frame(states, *self._outer)
        radius = self._outer_radii[sleeve - self.layout.external_bodies.start]
        larger = radius - self.scene.gear.edge_offset_m
        within, at = np.ones(local.size, dtype=np.bool_), []
        for flank in self._flanks:
            p = local * np.conj(flank)
            inside, a = self.curve.inside(p)
            # A pin that made the edge touches only when its centre is within the epitrochoid (a vertex within its radius
            # implies it, too), a larger one from a little outside.
            if np.any(larger > 0.0):
                # The normal leans from the radius by less than asin m + asin(e/R).
                lean = math.asin(self.curve.shortening) + math.asin(self.curve.ratio)
                reach = larger / math.cos(min(1.1 * lean, 1.5))
                inside |= np.abs(p) < np.abs(self.curve.point(a)) + reach
            within &= inside
            at.append((p, a))
        kept = np.nonzero(within)[0]
        feet = [self._on_edge(p[kept], a[kept], radius[kept]) for p, a in at]
        touch = feet[0] if len(feet) == 1 else self._on_flanks(local[kept], radius[kept], feet)
        return _on_ground(states, kept, state, wheel, sleeve, turn, touch)

    def _on_flanks(self, local: Points, radius: Floats, feet: list[Touch]) -> Touch:
        """Touch of a disc with turned flanks: the nearer of both feet on the edge of their common part, or its corner.

        Counter-clockwise of a lobe's middle that edge is the disc's that is turned clockwise.
        """
        zs = self.curve.lobes
        turned = zip(feet, self._flanks, strict=True)
        sides = [(point * flank, normal * flank, *rest) for (point, normal, *rest), flank in turned]
        on_edge = [sign * np.sin(zs * np.angle(side[0])) >= 0.0 for side, sign in zip(sides, (-1.0, 1.0), strict=True)]
        second = on_edge[1] & (~on_edge[0] | (sides[1][2] > sides[0][2]))
        number = np.rint(np.angle(local) * zs / math.pi)
        a = self._corner_parameters[np.mod(number, 2.0).astype(np.intp)]
        q = self.scene.gear.edge_offset_m
        corner = np.abs(self.curve.point(a) - q * self.curve.normal(a)) * np.exp(1j * number * math.pi / zs)
        apart = np.abs(corner - local)
        with np.errstate(divide="ignore", invalid="ignore"):
            normal = (corner - local) / apart
        last = (corner, normal, radius - apart, self.profile_radius(a, radius), np.zeros_like(radius))
        none = ~(on_edge[0] | on_edge[1])
        point, normal, delta, effective, slope = (
            np.where(none, end, np.where(second, other, one)) for one, other, end in zip(*sides, last, strict=True)
        )
        return point, normal, delta, effective, slope

    def _corners(self) -> list[float]:
        """The curve's parameters at which the edge stands delta beyond the middle of a lobe, and of a pit."""
        half, turn, q = math.pi / self.curve.lobes, self.scene.gear.rotational_rad, self.scene.gear.edge_offset_m
        corners = []
        for middle in (0.0, half):
            low, high = middle, middle + half
            for _ in range(60):
                a = np.array([0.5 * (low + high)])
                edge = self.curve.point(a) - q * self.curve.normal(a)
                if np.angle(edge * np.exp(-1j * (middle + turn)))[0] < 0.0:
                    low = float(a[0])
                else:
                    high = float(a[0])
            corners.append(high)
        return corners

    def _on_edge(self, local: Points, a: Floats, radius: Floats) -> Touch:
        """W, n, delta, R and dR/ds of pins centred at `local`; `a`: the curve's parameter at their polar angles."""
        if self.points:
            vertex, apart = nearest_vertex(local, self._profile)
            point, softness = self._profile[vertex], 1.0 + radius * self._profile_curvature[vertex]
            with np.errstate(divide="ignore", invalid="ignore"):
                normal = (point - local) / apart
            return point, normal, radius - apart, radius / softness, np.zeros_like(radius)
        q = self.scene.gear.edge_offset_m
        a, signed = self.curve.closest(local, a)
        outward = self.curve.normal(a)
        effective = self.profile_radius(a, radius)
        slope = np.zeros_like(radius) if self._line is None else self._profile_radius_slope(a, radius, signed)
        return self.curve.point(a) - q * outward, -outward, (radius - q) - signed, effective, slope

    def _touching_holes(self, states: Floats) -> Pairs:
        """Output pins against the holes."""
        state, wheel, sleeve, local, turn = self._sleeves_in_wheel_frame(states, *self._inner)
        which_wheel = wheel - self.layout.wheel_bodies.start
        which_hole = sleeve - self.layout.internal_bodies.start
        hole, rim = self._holes[which_wheel, which_hole], self._hole_radii[which_wheel, which_hole]
        radius = self._inner_radii[which_hole]
        from_centre = local - hole
        away = np.abs(from_centre)
        kept = np.nonzero(radius - (rim - away) > 0.0)[0]
        local, hole, from_centre, away = local[kept], hole[kept], from_centre[kept], away[kept]
        radius, rim = radius[kept], rim[kept]
        if self.points:
            vertex, _ = nearest_vertex(from_centre / rim, self._rim)
            point = hole + rim * self._rim[vertex]
            apart = np.abs(local - point)
            delta = radius - apart
            with np.errstate(divide="ignore", invalid="ignore"):
                normal = (point - local) / apart
        else:
            normal = from_centre / away
            point = hole + rim * normal
            delta = radius - (rim - away)
        touch = point, normal, delta, _radius_in_hole(rim, radius), np.zeros_like(radius)
        return _on_ground(states, kept, state, wheel, sleeve, turn, touch)

    @staticmethod
    def _sleeves_in_wheel_frame(states: Floats, wheels: Ints, sleeves: Ints) -> tuple[Ints, Ints, Ints, Points, Points]:
        """Every pair of every state: indices, the pin's centre in the disc's frame, e^{i disc angle}."""
        count = states.shape[0]
        state = np.repeat(np.arange(count), wheels.size)
        wheel, sleeve = np.tile(wheels.ravel(), count), np.tile(sleeves.ravel(), count)
        w, s = states[state, wheel], states[state, sleeve]
        turn = np.exp(1j * w[:, 2])
        local = ((s[:, 0] - w[:, 0]) + 1j * (s[:, 1] - w[:, 1])) * np.conj(turn)
        return state, wheel, sleeve, local, turn


def _radius_in_hole(hole: Floats, sleeve: Floats) -> Floats:
    """R of pins in holes, m: R_c is minus the hole's radius."""
    return np.asarray(-hole * sleeve / (sleeve - hole))


def _on_ground(states: Floats, kept: Ints, state: Ints, wheel: Ints, sleeve: Ints, turn: Points, touch: Touch) -> Pairs:
    """Turns the touching pairs among `kept` from the disc's frame into the ground's."""
    point, normal, delta, effective, slope = touch
    touching = delta > 0.0
    pair = kept[touching]
    state, wheel, sleeve, turn = state[pair], wheel[pair], sleeve[pair], turn[pair]
    centre = states[state, wheel, 0] + 1j * states[state, wheel, 1]
    ground = centre + point[touching] * turn
    return state, wheel, sleeve, ground, normal[touching] * turn, delta[touching], effective[touching], slope[touching]


def velocity_at(body: Floats, point: Points) -> Points:
    """Material velocity, m/s, of bodies (n, 6) at points of the ground frame."""
    arm = point - (body[:, 0] + 1j * body[:, 1])
    return np.asarray(body[:, 3] + 1j * body[:, 4] + 1j * body[:, 5] * arm)


def evaluate(scene: Scene, states: Floats) -> Floats:
    """Loads (n, bodies, 3) = fx, fy, moment about the centre of mass, N and N m, of states (n, bodies, 6)."""
    return ContactLaw(scene).loads(states)
