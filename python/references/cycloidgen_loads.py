"""Loads of the zero-clearance mesh on linear springs, by the package cycloidgen.

For each scene named on the command line: one of its discs, which carries its share of the load torque, at evenly spaced
poses over the pitch of the ring pins and over the period of the internal ones. Prints JSON with every pose, or with
`--toml` the extremes, as `reference/published/cycloidgen.toml` records them. Runs in an environment made from
`requirements-cycloidgen.txt`, with the folder `python` on the path.

What is printed is in Pinwheel's terms: angles counter-clockwise, pin 0 at angle 0 and counted the same way, lengths in m,
levers above 0 where a pin can push.
"""

from __future__ import annotations

import argparse
import json
import sys
from math import gcd
from pathlib import Path
from typing import Any

import numpy as np

try:
    from cycloidgen.analysis.stiffness import (
        RAD_PER_ARCMIN,
        _output_contacts,
        _ring_contacts,
        _solve_rotation,
        analyse_stiffness,
    )
    from cycloidgen.core.kinematics import contacts, mesh_gaps, output_loads, output_stage_period
    from cycloidgen.core.spec import GearSpec, OffsetMode
except ModuleNotFoundError as error:
    sys.exit(f"{error}; install it with `pip install --require-hashes --no-deps -r python/requirements-cycloidgen.txt`")

from pinwheel_engines.scene import Scene

# Number of poses over a period, whose extremes are recorded.
POSES = 48
# Modification of the profile, equidistant or of the pin circle.
CLEARANCE_MM = 0.05
# Modification and line length for the twist under load, where gaps are of the size of the contacts' depths: with larger
# ones the package's straight levers tell other pins to carry.
GAP_MM = 0.002
LINE_MM = 10.0
# Poses over the period of the mesh, and corners a lobe of the polygon that stands for the profile: gaps to a few nanometres.
TWIST_POSES = 8
CORNERS = 3000
# Pins on the line of centres have levers of 1e-17 m and forces to match: they carry nothing.
NOTHING_N = 1e-9


def specification(scene: Scene) -> GearSpec:
    """Gear in the package's form."""
    gear = scene.gear
    return GearSpec(
        pin_circle_radius=1e3 * gear.pitch_radius_m,
        pin_radius=1e3 * gear.external_sleeve_radius_m,
        eccentricity=1e3 * gear.eccentricity_m,
        lobes=gear.lobes,
        disc_count=gear.wheels,
        output_pin_count=gear.internal_sleeves,
        output_pin_diameter=2e3 * gear.internal_sleeve_radius_m,
        output_bolt_circle_radius=1e3 * gear.internal_circle_radius_m,
        output_torque_Nm=scene.drive.output_torque_n_m,
    )


def play_arcmin(spec: GearSpec, mode: OffsetMode) -> float:
    """Largest free play of the ring stage with the profile cut smaller by `CLEARANCE_MM`, both directions."""
    cut = spec.model_copy(update={"profile_clearance": CLEARANCE_MM, "offset_mode": mode})
    return float(analyse_stiffness(cut).lost_motion_ring_arcmin)


def palmgren(stage: Any) -> Any:
    """The stage's contacts with our law `line-contact` for all of them, of the same exponent as the package's own."""
    return stage._replace(c=np.full(stage.arms.size, 3.84e-5 / LINE_MM**0.8))


def twist_arcmin(spec: GearSpec, phi: float, torque_n_m: float) -> float:
    """Returns the angles of one disc and the output under a torque, the input locked: the package's solver, by stages."""
    # The other direction is the mirrored pose.
    side, torque = (1.0 if torque_n_m > 0 else -1.0), 1e3 * abs(torque_n_m)
    pose = contacts(spec, side * phi)
    gaps = mesh_gaps(spec, side * phi, CORNERS * spec.lobes)[pose.loaded_mask] if spec.profile_clearance else 0.0
    ring = palmgren(_ring_contacts(spec, pose, torque))
    ring = ring._replace(gaps=np.maximum(gaps, np.zeros(ring.arms.size)))
    output = palmgren(_output_contacts(spec, -side * phi, torque))
    turned = sum(_solve_rotation(stage.c, stage.arms, stage.gaps, torque)[0] for stage in (ring, output))
    return float(side * turned / RAD_PER_ARCMIN)


def compliance(spec: GearSpec, mode: OffsetMode | None, torque_n_m: float) -> list[float]:
    """Lost motion, stiffness and transmission error of one disc.

    At 3 % of the torque, arcmin, mean over the poses; from 50 to 100 %, N m/arcmin, of the mean twist; under all of it,
    arcmin, peak to peak.
    """
    cut = {"disc_count": 1, "hole_clearance": 0.0, "profile_clearance": 0.0 if mode is None else GAP_MM}
    one = spec.model_copy(update=cut if mode is None else {**cut, "offset_mode": mode})
    period = 2 * np.pi * spec.lobes / (spec.lobes + 1) / gcd(spec.lobes, spec.output_pin_count)
    poses = np.linspace(0.0, period, TWIST_POSES, endpoint=False)

    def twists(share: float) -> Any:
        return np.array([twist_arcmin(one, float(phi), share * torque_n_m) for phi in poses])

    half, full = twists(0.5), twists(1.0)
    lost = np.mean(twists(0.03) - twists(-0.03))
    return [float(lost), 0.5 * torque_n_m / float(np.mean(full - half)), float(np.ptp(full))]


def ring_pose(spec: GearSpec, phi: float, torque_n_m: float) -> dict[str, Any]:
    """All ring pins at one angle of the eccentric, and their sum along and across it.

    The package's crank turns the other way (centre at e (cos phi, -sin phi)): its picture is mirrored, pin by pin.
    """
    state = contacts(spec, phi)
    forces = state.forces(1e3 * torque_n_m)
    along = np.array([np.cos(phi), -np.sin(phi)])
    bearing = (forces[:, None] * state.normals).sum(axis=0)
    mirror = -np.arange(forces.size)
    return {
        "input_rad": phi,
        "levers_m": (-1e-3 * state.moment_arms[mirror]).tolist(),
        "forces_n": forces[mirror].tolist(),
        # Force of the pins on the disc, mirrored too.
        "bearing_n": [-float(bearing @ along), float(bearing @ [along[1], -along[0]])],
    }


def output_pose(spec: GearSpec, phi: float, torque_n_m: float) -> dict[str, Any]:
    """All output pins at one angle of the eccentric.

    The package loads those whose moment on the disc has the sense of the external ones', where equilibrium wants the
    opposite. Its figures are therefore those of the mirrored pose, which two mirrors make ours but for the angle.
    """
    state = output_loads(spec, -phi, 1e3 * torque_n_m)
    return {"input_rad": phi, "levers_m": (-1e-3 * state.moment_arms).tolist(), "forces_n": state.forces.tolist()}


def loads(scene: Scene) -> dict[str, Any]:
    """Returns all computed loads of one scene."""
    spec = specification(scene)
    torque = scene.drive.output_torque_n_m / scene.gear.wheels
    pitch = 2 * np.pi / scene.gear.external_sleeves
    ring = [ring_pose(spec, float(phi), torque) for phi in np.linspace(0.0, pitch, POSES, endpoint=False)]
    period = output_stage_period(spec.lobes, spec.output_pin_count)
    output = [output_pose(spec, float(phi), torque) for phi in np.linspace(0.0, period, POSES, endpoint=False)]

    def extremes(values: list[Any]) -> list[Any]:
        return [min(values), max(values)]

    def loaded(pose: dict[str, Any]) -> int:
        return sum(force > NOTHING_N for force in pose["forces_n"])

    return {
        "scene": scene.name,
        "wheel_torque_n_m": torque,
        "peak_n": extremes([max(pose["forces_n"]) for pose in ring]),
        "loaded_sleeves": extremes([loaded(pose) for pose in ring]),
        "bearing_n": extremes([float(np.hypot(*pose["bearing_n"])) for pose in ring]),
        "output_n": extremes([max(pose["forces_n"]) for pose in output]),
        "loaded_output_sleeves": extremes([loaded(pose) for pose in output]),
        "play_arcmin": [play_arcmin(spec, mode) for mode in (OffsetMode.EQUIDISTANT, OffsetMode.PIN_CIRCLE)],
        "compliance": [
            figure
            for mode in (None, OffsetMode.EQUIDISTANT, OffsetMode.PIN_CIRCLE)
            for figure in compliance(spec, mode, torque)
        ],
        "forces_n": [force for force in ring[0]["forces_n"] if force > NOTHING_N],
        "ring": ring,
        "output": output,
    }


def main() -> None:
    """Runs the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("scenes", nargs="+", type=Path, metavar="SCENE.toml")
    parser.add_argument("--toml", action="store_true", help="the extremes only, as they are recorded")
    options = parser.parse_args()
    gears = [loads(Scene.load(path)) for path in options.scenes]
    if not options.toml:
        print(json.dumps(gears))
        return
    for gear in gears:
        print("\n[[gear]]")
        for key, value in gear.items():
            if key not in ("ring", "output"):
                print(f"{key} = {json.dumps(value)}")


if __name__ == "__main__":
    main()
