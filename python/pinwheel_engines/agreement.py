"""Differences of two implementations of the contact law at equal random states, and the share of rounding in them.

Points detection takes the nearest of a disc's points. Where two are equally near but for rounding, two correct
implementations may take different ones, whose normals differ by one spacing: such states are counted and left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pinwheel_engines.bed import nominal_penetration_m, nominal_rate_rad_s
from pinwheel_engines.border import LawPointer, StageLaw
from pinwheel_engines.law import ContactLaw
from pinwheel_engines.layout import Kinematics
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]

# Largest difference of two correct implementations, in roundings; a larger one has another cause.
MOST_ROUNDINGS = 4.0


@dataclass(frozen=True)
class Agreement:
    """Largest differences over all compared states."""

    states: int
    loaded: int
    """States in which something touches."""
    ambiguous: int
    """States left out because of a tie between two points."""
    worst_n: float
    """Difference of a force, N."""
    largest_n: float
    """The largest force in any state, N."""
    worst_relative: float
    """Difference of a force, over the largest force of its state; where nearly nothing touches, rounding is all there is."""
    worst_over_rounding: float
    """Difference of a force, over `ContactLaw.rounding_n` of its state."""
    worst_moment_relative: float
    """Difference of a moment, over the largest force of its state times the largest radius of the mechanism."""


def tie_m(scene: Scene) -> float:
    """Tolerance of a tie of two distances, m: a hundred units in the last place of the pitch radius."""
    return float(100.0 * np.spacing(scene.gear.pitch_radius_m))


def random_states(scene: Scene, count: int, seed: int) -> Floats:
    """Random states near the mesh, within the backlash: any input angle, deviating angles and rates, turning pins."""
    rng = np.random.default_rng(seed)
    kinematics = Kinematics(scene.gear)
    layout = kinematics.layout
    states = np.empty((count, layout.bodies, 6))
    # More than one full cycle of the mesh.
    span_s = 2.0 * np.pi * scene.gear.lobes / max(abs(scene.drive.input_speed_rad_s), 1e-3)
    # About an eighth of a disc's turn under its nominal force: contacts come and go, and forces are of their own size.
    spread_rad = 0.12 * nominal_penetration_m(scene) / (scene.gear.eccentricity_m * scene.gear.lobes)
    spread_rad_s = 0.03 * nominal_rate_rad_s(scene) * spread_rad / 0.12
    play_rad = (scene.gear.backlash_m + scene.gear.extra_play_m) / (scene.gear.eccentricity_m * scene.gear.lobes)
    for i in range(count):
        angles, rates = kinematics.ideal(scene, rng.uniform(0.0, span_s))
        angles[1:] += rng.uniform(-1.0, 1.0) * play_rad
        angles[1 : layout.wheel_bodies.stop] += rng.normal(size=1 + layout.wheels) * spread_rad
        rates[1:] += rng.normal(size=layout.bodies - 1) * spread_rad_s
        states[i] = kinematics.states(angles, rates)
    return states


def compare(scene: str | Scene, pointer: LawPointer, count: int, seed: int) -> Agreement:
    """Evaluates the numpy law and a compiled one at the same random states of a scene, itself or its TOML text.

    Raises Unsupported for a law that numpy does not know.
    """
    scene = Scene.of(scene)
    law, compiled = ContactLaw(scene), StageLaw(scene, pointer)
    states = random_states(scene, count, seed)
    ours = law.loads(states)
    theirs = np.empty_like(ours)
    for i, state in enumerate(states):
        compiled.states[:] = state
        theirs[i] = compiled.evaluate_at(0.0)
    difference = theirs - ours
    rounding = law.rounding_n(states)
    force = np.abs(difference[..., :2]).max(axis=(1, 2))
    clear = np.ones(count, dtype=np.bool_)
    if law.points:
        # A tie is the only other valid cause; it is checked only for states that differ by more than rounding.
        for row in np.nonzero(force > MOST_ROUNDINGS * rounding)[0]:
            clear[row] = law.nearest_gap_m(states[row]) > tie_m(scene)
    size = np.abs(ours[..., :2]).max(axis=(1, 2))
    moment = np.abs(difference[..., 2]).max(axis=1)
    loaded = clear & (size > 0.0)
    reach = scene.gear.pitch_radius_m
    return Agreement(
        states=count,
        loaded=int(loaded.sum()),
        ambiguous=int(count - clear.sum()),
        worst_n=float(force[clear].max(initial=0.0)),
        largest_n=float(size.max(initial=0.0)),
        worst_relative=float((force[loaded] / size[loaded]).max(initial=0.0)),
        worst_over_rounding=float((force[loaded] / rounding[loaded]).max(initial=0.0)),
        worst_moment_relative=float((moment[loaded] / (size[loaded] * reach)).max(initial=0.0)),
    )
