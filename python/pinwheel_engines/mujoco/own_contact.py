"""MuJoCo, own contact: the disc's edge as a bed of small spheres, the holes as limited tendons.

MuJoCo finds the contacts and computes their forces; no code of ours runs in the step. Its soft constraint gives
    f = -(k r + b v + a1)/R,  R = (1 - d)/d W,
with the constraint's acceleration a1, impedance d and inverse mass W. With W set to a large number after compiling, a1/R
vanishes and solref = -(K, C)(1 - d) W makes it a spring K and a damper C in newtons: MuJoCo's usual scaling with the
touching bodies' masses is out.
- Ring pins: spheres of 0.1 mm or less along the edge at equal distances, each a spring of the bed (see `bed`).
- Output pins: the distance of pin and hole centre is a tendon limited to their difference in radius. Several
  tendons a pair, each limited a little further out, add up to a chord approximation of K delta^1.5.
The driver is a rotor inertia of 1e10 discs on the input hinge (1e16 would drown the rest in the solver's tolerance).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import mujoco
import numpy as np
import numpy.typing as npt

from pinwheel_engines.bed import (
    bed_damping,
    bed_stiffness,
    check_own_contact,
    edge,
    equal_arcs,
    hertz,
    local_stiffness,
    nominal_force_n,
    nominal_step_s,
    nominal_torque_n_m,
    springs,
)
from pinwheel_engines.errors import Cancelled, Diverged
from pinwheel_engines.guards import Guard
from pinwheel_engines.layout import INPUT, OUTPUT, Kinematics, hole_centres
from pinwheel_engines.mujoco.model import coordinates, tree_xml
from pinwheel_engines.mujoco.session import VERSION, check_data, quiet_session
from pinwheel_engines.result import Recorder, Result, RunStats
from pinwheel_engines.scene import Scene
from pinwheel_engines.start import initial_angles
from pinwheel_engines.stepping import actual_step_s, legs, steps_between

Floats = npt.NDArray[np.float64]

NAME = "mujoco-own-contact"

# Rotor inertia of the driver in moments of inertia of a disc.
DRIVER_WHEELS = 1.0e10
# Least beads along an edge, and within the nominal contact; their radius in pin radii and m, the lesser counts.
BEADS, BEADS_IN_CONTACT = 4000, 7
BEAD_SHARE, BEAD_RADIUS_M = 0.04, 1.0e-4
# Impedance d, and the inverse mass W, which replaces MuJoCo's, in those of a disc: R = W/d, so a1/R is some 1e-8 of the
# force that gives a disc the acceleration a1.
IMPEDANCE = 1.0e-4
INVERSE_MASSES = 4.0e3
# Tendons a pin and hole, and how far, in nominal penetrations, their chords follow K delta^1.5.
CHORDS = 32
REACH = 4.0


def inverse_mass(scene: Scene) -> float:
    """W, 1/kg: a power of ten."""
    return float(10.0 ** round(math.log10(INVERSE_MASSES / scene.mass.wheel.mass_kg)))


def bead_radius_m(scene: Scene) -> float:
    """Radius of the beads, m."""
    return float(min(BEAD_RADIUS_M, BEAD_SHARE * scene.gear.external_sleeve_radius_m))


def chords(scene: Scene) -> list[tuple[float, float]]:
    """Onset (m) and stiffness (N/m) of the springs whose sum follows K delta^1.5 between equal-square-root knots."""
    stiffness, gear = hertz(scene).hole_stiffness, scene.gear
    force = 4.0 * nominal_torque_n_m(scene) / (gear.internal_sleeves * gear.internal_circle_radius_m)
    far = REACH * (max(force, nominal_force_n(scene)) / stiffness) ** (2.0 / 3.0)
    knots = far * (np.arange(CHORDS + 1) / CHORDS) ** 2
    slopes = np.diff(stiffness * knots**1.5) / np.diff(knots)
    return list(zip(knots[:-1].tolist(), np.diff(slopes, prepend=0.0).tolist(), strict=True))


def model_xml(scene: Scene, step_s: float, beads: int) -> str:
    """The mechanism with beads on the discs' edges and tendons in their holes."""
    gear, kinematics = scene.gear, Kinematics(scene.gear)
    layout = kinematics.layout
    a, spacing = equal_arcs(scene, beads)
    radius_m, scale = bead_radius_m(scene), (1.0 - IMPEDANCE) * inverse_mass(scene)
    centres = edge(scene, a, radius_m)
    holes = hole_centres(gear)

    def soft(stiffness: float, damping: float) -> str:
        """MuJoCo's solref for a spring and damper in N/m and N s/m (see the module's text)."""
        return f"{-stiffness * scale!r} {-damping * scale!r}"

    stiffness, damping = bed_stiffness(scene) * spacing, bed_damping(scene) * spacing
    springs_of = [soft(float(local) * stiffness, damping) for local in local_stiffness(scene, beads, radius_m)]

    def content(body: int) -> str:
        if layout.wheel_bodies.start <= body < layout.wheel_bodies.stop:
            wheel = body - layout.wheel_bodies.start
            rim = "".join(
                f'<geom class="bead" pos="{z.real!r} {z.imag!r} 0" solref="{bead}"/>'
                for z, bead in zip(centres.tolist(), springs_of, strict=True)
            )
            sites = "".join(
                f'<site name="h{wheel}_{k}" pos="{z.real!r} {z.imag!r} 0"/>' for k, z in enumerate(holes[wheel].tolist())
            )
            return rim + sites
        if layout.external_bodies.start <= body < layout.external_bodies.stop:
            return '<geom class="sleeve"/>'
        if layout.internal_bodies.start <= body:
            return f'<site name="s{body - layout.internal_bodies.start}"/>'
        return ""

    play = gear.hole_radius_m - gear.internal_sleeve_radius_m
    tendons = []
    for wheel in range(gear.wheels):
        for k in range(gear.internal_sleeves):
            for i, (onset, stiffness) in enumerate(chords(scene)):
                damping = scene.contact.damping_n_s_m if i == 0 else 0.0
                tendons.append(
                    f'<spatial name="t{wheel}_{k}_{i}" limited="true" range="0 {play + onset!r}" '
                    f'solreflimit="{soft(stiffness, damping)}" solimplimit="{IMPEDANCE} {IMPEDANCE} 1 0.5 1">'
                    f'<site site="h{wheel}_{k}"/><site site="s{k}"/></spatial>'
                )
    impedance = f'solimp="{IMPEDANCE} {IMPEDANCE} 1 0.5 1"'
    return (
        f'<mujoco><option integrator="implicit" timestep="{step_s!r}" gravity="0 0 0" solver="Newton" iterations="100" '
        'tolerance="1e-12"><flag autoreset="disable"/></option>'
        "<default>"
        f'<default class="bead"><geom type="sphere" size="{radius_m!r}" contype="1" conaffinity="0" condim="1" '
        f'priority="1" mass="0" {impedance}/></default>'
        f'<default class="sleeve"><geom type="sphere" size="{gear.external_sleeve_radius_m!r}" contype="0" '
        f'conaffinity="1" condim="1" mass="0"/></default></default>'
        f"<worldbody>{tree_xml(scene, scene.mass.driver_kg_m2(DRIVER_WHEELS), content)}</worldbody>"
        f"<tendon>{''.join(tendons)}</tendon></mujoco>"
    )


class _Machine:
    """Model and data of one run, and how to read its forces."""

    def __init__(self, scene: Scene, step_s: float, beads: int, initial: Floats | None) -> None:
        self.scene, self.driver_kg_m2 = scene, scene.mass.driver_kg_m2(DRIVER_WHEELS)
        self.kinematics = Kinematics(scene.gear)
        self.model = mujoco.MjModel.from_xml_string(model_xml(scene, step_s, beads))
        # Before the data exist: every constraint takes its inverse mass from these.
        self.model.body_invweight0[:] = 0.5 * inverse_mass(scene)
        self.model.tendon_invweight0[:] = inverse_mass(scene)
        self.data = mujoco.MjData(self.model)
        self.load = scene.drive.load_piece(0.0)
        self.coordinate = coordinates(self.kinematics, self.model)
        angles, rates = initial_angles(scene, initial)
        self.data.qpos[self.coordinate] = self.kinematics.relative(angles)
        self.data.qvel[self.coordinate] = self.kinematics.relative(rates)
        gear, layout = scene.gear, self.kinematics.layout
        # Which ring pin a geom belongs to, -1 for a bead.
        first = layout.external_bodies.start
        sleeve_of_body = {self.model.body(f"b{first + j}").id: j for j in range(gear.external_sleeves)}
        self.sleeve_of_geom = np.array([sleeve_of_body.get(int(b), -1) for b in self.model.geom_bodyid])
        # Disc and pin of every tendon.
        self.tendon_wheel = np.repeat(np.arange(gear.wheels), gear.internal_sleeves * CHORDS)
        self.tendon_sleeve = np.tile(np.repeat(np.arange(gear.internal_sleeves), CHORDS), gear.wheels)
        self.hole_sites = np.array(
            [[self.model.site(f"h{w}_{k}").id for k in range(gear.internal_sleeves)] for w in range(gear.wheels)]
        )
        self.sleeve_sites = np.array([self.model.site(f"s{k}").id for k in range(gear.internal_sleeves)])

    def absolute(self) -> tuple[Floats, Floats]:
        """Absolute angles and rates of all bodies."""
        kinematics, data = self.kinematics, self.data
        return kinematics.absolute(data.qpos[self.coordinate]), kinematics.absolute(data.qvel[self.coordinate])

    def set_load(self, time_s: float) -> None:
        """The load on the output shaft."""
        self.data.qfrc_applied[self.coordinate[OUTPUT]] = self.load.load_n_m(time_s)

    def forces(self) -> tuple[npt.NDArray[np.complex128], npt.NDArray[np.complex128]]:
        """Contact force on every ring and output pin, vector sums over the discs, N, ground frame."""
        gear, data = self.scene.gear, self.data
        outer = np.zeros(gear.external_sleeves, dtype=np.complex128)
        contact = data.contact
        if data.ncon > 0:
            active = contact.efc_address >= 0
            geoms, frames = contact.geom[active], contact.frame[active]
            size = data.efc_force[contact.efc_address[active]]
            # The frame's first axis points from the first geom to the second, and the force on the second along it.
            second = self.sleeve_of_geom[geoms[:, 1]]
            first = self.sleeve_of_geom[geoms[:, 0]]
            force = size * (frames[:, 0] + 1j * frames[:, 1]) * np.where(second >= 0, 1.0, -1.0)
            np.add.at(outer, np.maximum(first, second), force)
        inner = np.zeros(gear.internal_sleeves, dtype=np.complex128)
        limits = np.nonzero(data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON))[0]
        if limits.size:
            tendon = data.efc_id[limits]
            wheel, sleeve = self.tendon_wheel[tendon], self.tendon_sleeve[tendon]
            span = data.site_xpos[self.sleeve_sites[sleeve]] - data.site_xpos[self.hole_sites[wheel, sleeve]]
            direction = (span[:, 0] + 1j * span[:, 1]) / np.hypot(span[:, 0], span[:, 1])
            np.add.at(inner, sleeve, -data.efc_force[limits] * direction)
        return outer, inner


def run(
    scene: Scene,
    on_progress: Callable[[float], bool] | None = None,
    step_s: float | None = None,
    initial: Floats | None = None,
    beads: int | None = None,
) -> Result:
    """Runs a scene without friction. `beads`: springs along each disc's edge, by default as many as it needs.

    `step_s`: by default `bed.nominal_step_s`; MuJoCo's step is explicit in springs and dampers.

    Raises Diverged with the courses until then, Cancelled, EngineFailed, Unsupported.
    """
    check_own_contact(NAME, scene)
    beads = beads or springs(scene, BEADS, BEADS_IN_CONTACT)
    guard = Guard(NAME, scene)
    wanted = nominal_step_s(scene) if step_s is None else step_s
    wall, cpu = time.perf_counter(), time.thread_time()
    with quiet_session():
        mujoco.set_mjcb_passive(None)
        mujoco.set_mjcb_control(None)
        machine = _Machine(scene, wanted, beads, initial)
        model, data = machine.model, machine.data
        recorder = Recorder(scene, machine.kinematics)
        times, breaks = recorder.times_s, scene.drive.load_breaks_s
        steps = 0

        def finish() -> Result:
            stats = RunStats(
                wall_s=time.perf_counter() - wall,
                cpu_s=time.thread_time() - cpu,
                steps=steps,
                degrees_of_freedom=int(model.nv),
                bodies=machine.kinematics.layout.bodies,
                step_s=actual_step_s(recorder.times_s, wanted),
                settings=f"implicit, {beads} beads an edge, {CHORDS} tendons a hole, "
                f"driver as armature {machine.driver_kg_m2:g} kg m^2",
                versions={"mujoco": VERSION, "numpy": np.__version__},
                notes=["the ramp S of the contact law and contact.detection have no counterpart in a bed of springs"],
            )
            return Result(NAME, recorder.columns(), stats)

        try:
            for k, instant in enumerate(times):
                time_s = float(instant)
                if k > 0:
                    for start, end in legs(float(times[k - 1]), float(instant), breaks, wanted):
                        machine.load = scene.drive.load_piece(0.5 * (start + end))
                        count, model.opt.timestep = steps_between(start, end, wanted)
                        data.time = start
                        _advance(machine, count, scene.drive.load_varies)
                        steps += count
                    check_data(guard, data, time_s)
                machine.set_load(time_s)
                mujoco.mj_forward(model, data)
                angles, rates = machine.absolute()
                guard.check_states(time_s, angles, rates)
                outer, inner = machine.forces()
                forces = np.abs(np.concatenate([outer, inner]))
                guard.check_forces(time_s, forces)
                recorder.record_forces(
                    -machine.driver_kg_m2 * float(data.qacc[machine.coordinate[INPUT]]),
                    machine.kinematics.torque_of_pins(angles[OUTPUT], outer, inner),
                    float(angles[OUTPUT]),
                    forces,
                )
                if on_progress is not None and on_progress(time_s):
                    raise Cancelled
        except Diverged as error:
            error.partial = finish()
            raise
        return finish()


def _advance(machine: _Machine, count: int, varies: bool) -> None:
    """`count` steps from a sample; a load that varies is set anew for each."""
    if not varies:
        # The sample's evaluation is that of the first step.
        mujoco.mj_implicit(machine.model, machine.data)
        mujoco.mj_step(machine.model, machine.data, count - 1)
        return
    for _ in range(count):
        machine.set_load(machine.data.time + 0.5 * machine.model.opt.timestep)
        mujoco.mj_step(machine.model, machine.data)
