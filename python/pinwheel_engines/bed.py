"""A bed of linear springs in place of the Hertzian law, for engines that resolve contact themselves.

Springs of stiffness k' a metre of edge, pressed by a conformal counterpart of reduced radius R = R_c R_p/(R_c + R_p) with
penetration delta, are loaded over |x| < sqrt(2 R delta) with depth delta - x^2/(2 R). Together they give
    F = k' (4 sqrt 2/3) sqrt(R) delta^1.5,
so k' = 3 K0/(4 sqrt 2), with K = K0 sqrt(R) from Eq. 23, reproduces K delta^1.5 and its dependence on the local curvature.
The ramp S of Eq. 22 has no counterpart. A damper c' a metre gives c' 2 sqrt(2 R delta), which equals C at one penetration
only: the one under the gear's nominal pin force.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import Unsupported
from pinwheel_engines.geometry import Epitrochoid
from pinwheel_engines.law import ContactLaw
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]
Points = npt.NDArray[np.complex128]


# Least nominal penetration in ramps S. The paper's gear has 7, where leaving S out costs under 1 % of the forces' RMS; with
# H = 1 it has 0.3 and the difference is 18 %.
LEAST_RAMPS = 3.0


# Local factors: points per spring, and number of corrections; the second leaves less than 1e-2 of the first's correction.
FINER, ROUNDS = 4, 3


# Springs follow the first law's forces and, like the second, come from an energy.
LAWS = ("paper", "paper-conservative")


def hertz(scene: Scene) -> ContactLaw:
    """Stiffnesses after Hertz, which every scene has, independent of its law."""
    return ContactLaw(scene.with_keys("contact", law="paper", friction_law="regularised", detection="exact"))


def check_own_contact(engine: str, scene: Scene) -> None:
    """Raises Unsupported for what a spring bed cannot honour."""
    contact = scene.contact
    if contact.law not in LAWS:
        raise Unsupported(engine, f'contact.law = "{contact.law}": its own contact can imitate only {", ".join(LAWS)}')
    if scene.pin_n_m is not None:
        raise Unsupported(engine, "bearings.internal_sleeve_stiffness_n_m: its own contact has no pins in series")
    if contact.friction_coefficient != 0.0:
        raise Unsupported(
            engine, f"contact.friction_coefficient = {contact.friction_coefficient}: its own contact has none here"
        )

    gear = scene.gear
    if gear.rotational_rad != 0.0:
        raise Unsupported(engine, "gear.modification.rotational_rad: its edge is one smooth curve, not the meet of two")
    if gear.ring_turns and engine == "exudyn-own-contact":
        raise Unsupported(engine, 'drive.output = "ring": its damper on the discs is about a ring that stands still')
    if gear.normal_m:
        raise Unsupported(engine, "gear.modification.normal_m: its edge is that of an epitrochoid")
    if gear.has_errors:
        raise Unsupported(engine, "gear.errors: its pins and holes are all alike and stand in their nominal places")

    # Below the ramp Eq. 20 is a power of 2.5, which neither a bed of springs nor a power of 1.5 resembles.
    nominal = nominal_penetration_m(scene)
    if nominal < LEAST_RAMPS * contact.ramp_m:
        raise Unsupported(
            engine,
            f"the nominal penetration of {nominal:.2g} m is below {LEAST_RAMPS:g} times contact.ramp_m = "
            f"{contact.ramp_m:g}, so the ramp S shapes the forces and its own contact has none; take a softer contact or a "
            "shorter ramp",
        )


def bed_stiffness(scene: Scene) -> float:
    """k', N/m^2."""
    return 3.0 / (4.0 * math.sqrt(2.0)) * hertz(scene).stiffness_factor


def edge_stiffness(scene: Scene) -> float:
    """K of a ring pin where the profile is straight (R = q), N/m^1.5."""
    return hertz(scene).stiffness_factor * math.sqrt(scene.gear.external_sleeve_radius_m)


def nominal_torque_n_m(scene: Scene) -> float:
    """Largest load torque on one disc, N m; for a scene without load the one that presses a pin in by 1e-6 R."""
    gear, load = scene.gear, float(scene.drive.largest_load_n_m / scene.gear.wheels)
    if load > 0.0:
        return load
    force = edge_stiffness(scene) * (1e-6 * gear.pitch_radius_m) ** 1.5
    return float(0.25 * force * gear.eccentricity_m * gear.lobes * gear.external_sleeves)


def nominal_force_n(scene: Scene) -> float:
    """Largest ring pin force at zero clearance with linear springs, N: 4 T/(n e zs zk)."""
    gear = scene.gear
    return float(4.0 * nominal_torque_n_m(scene) / (gear.eccentricity_m * gear.lobes * gear.external_sleeves))


def nominal_rate_rad_s(scene: Scene) -> float:
    """Angular frequency of a disc on its loaded pins with the shafts held, rad/s: what an explicit step must resolve.

    Half of the pins are loaded, each with the tangent stiffness 1.5 K^(2/3) F^(1/3) at its nominal force and with a
    lever whose mean square is half the square of its greatest.
    """
    gear, torque = scene.gear, nominal_torque_n_m(scene)
    stiffness = 0.0
    for sleeves, lever, k in (
        (gear.external_sleeves, gear.eccentricity_m * gear.lobes, edge_stiffness(scene)),
        (gear.internal_sleeves, gear.internal_circle_radius_m, hertz(scene).hole_stiffness),
    ):
        force = 4.0 * torque / (sleeves * lever)
        stiffness += 0.25 * max(2, sleeves) * 1.5 * k ** (2.0 / 3.0) * force ** (1.0 / 3.0) * lever**2
    return math.sqrt(stiffness / scene.mass.wheel.moment_kg_m2)


def nominal_step_s(scene: Scene) -> float:
    """Step of the own-contact engines, s: limited by the disc's springs (1.1 radians) or dampers (half a time constant).

    The explicit methods used are stable to about twice as much.
    """
    gear = scene.gear
    levers = gear.external_sleeves * (gear.eccentricity_m * gear.lobes) ** 2
    levers += gear.internal_sleeves * gear.internal_circle_radius_m**2
    decay = 0.25 * scene.contact.damping_n_s_m * levers / scene.mass.wheel.moment_kg_m2
    rate = nominal_rate_rad_s(scene)
    return float(min(1.1 / rate, 0.5 / max(decay, 0.01 * rate)))


def nominal_penetration_m(scene: Scene) -> float:
    """Penetration of a ring pin under its nominal force where the profile is straight (R = q), m."""
    return float((nominal_force_n(scene) / edge_stiffness(scene)) ** (2.0 / 3.0))


def nominal_width_m(scene: Scene) -> float:
    """Width of the contact under the nominal force, m."""
    return 2.0 * math.sqrt(2.0 * scene.gear.external_sleeve_radius_m * nominal_penetration_m(scene))


def bed_damping(scene: Scene) -> float:
    """c', N s/m^2: the bed's damping equals C at the nominal force where the profile is straight (R = q)."""
    return float(scene.contact.damping_n_s_m / nominal_width_m(scene))


def springs(scene: Scene, least: int, in_contact: int) -> int:
    """Returns the springs of an edge: `least`, or so many that `in_contact` of them bear a pin's nominal force."""
    _, spacing = equal_arcs(scene, least)
    return max(least, math.ceil(least * in_contact * spacing / nominal_width_m(scene)))


def equal_arcs(scene: Scene, count: int) -> tuple[Floats, float]:
    """Parameters of `count` points at equal distances along the disc's edge, and that distance, m."""
    curve, q = Epitrochoid.of(scene.gear), scene.gear.edge_offset_m
    # The edge's speed is |C'| (1 - q kappa); the trapezoidal rule is spectrally accurate on a period.
    fine = np.linspace(0.0, 2.0 * math.pi, 200 * scene.gear.lobes * 8 + 1)
    m, zs = scene.gear.generating_shortening, scene.gear.lobes
    speed = curve.radius_m * np.abs(1.0 + m * np.exp(1j * zs * fine)) * (1.0 - q * curve.curvature(fine))
    length = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(fine))])
    wanted = length[-1] * np.arange(count) / count
    return np.interp(wanted, length, fine), float(length[-1] / count)


def local_stiffness(scene: Scene, count: int, bead_radius_m: float = 0.0) -> Floats:
    """Factors on k' of `count` springs at equal distances, with which the bed carries K delta^1.5 at the nominal force.

    The formula of the module assumes a flat patch. In a pit, where R is ten times q, the patch is as wide as a third of
    q: springs at its ends stand aslant and are pressed less, and the curvature varies over it. Beads moreover press like
    a larger pin. Both together took 7 % of the stiffness of a pit of 40 soft pins and gave 4 % to its lobes.
    """
    gear, curve = scene.gear, Epitrochoid.of(scene.gear)
    q, force = gear.external_sleeve_radius_m, nominal_force_n(scene)
    # Finer than the springs are: factors are those of a bed, wherever between two of them it is pressed.
    a, spacing = equal_arcs(scene, FINER * count)
    normal, bend = curve.normal(a), curve.curvature(a)
    reduced = q * (1.0 - gear.edge_offset_m * bend) / (1.0 + (q - gear.edge_offset_m) * bend)
    depth = (force / (hertz(scene).stiffness_factor * np.sqrt(reduced))) ** (2.0 / 3.0)
    sleeves, beads = edge(scene, a) + (q - depth) * normal, edge(scene, a, bead_radius_m)
    reach = math.ceil(1.5 * math.sqrt(2.0 * float((reduced * depth).max())) / spacing)
    factors = np.ones_like(a)
    for _ in range(ROUNDS):
        carried = np.zeros_like(a)
        for shift in range(-reach, reach + 1):
            span = sleeves - np.roll(beads, shift)
            away = np.abs(span)
            pressed = np.maximum(q + bead_radius_m - away, 0.0)
            carried += np.roll(factors, shift) * pressed * np.real(np.conj(normal) * span) / away
        factors *= force / (bed_stiffness(scene) * spacing * carried)
    return factors[::FINER]


def edge(scene: Scene, a: Floats, inset_m: float = 0.0) -> Points:
    """Points of the disc's edge, moved inwards by `inset_m`, in the disc's frame, m."""
    curve = Epitrochoid.of(scene.gear)
    return np.asarray(curve.point(a) - (scene.gear.edge_offset_m + inset_m) * curve.normal(a))
