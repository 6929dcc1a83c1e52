"""exudyn, own contact: sphere in hollow sphere for the output pins, circles on a polygon for the external ones.

exudyn finds the contacts and computes their forces; no code of ours runs in the step.
- Output pins: `ObjectContactSphereSphere`, hollow, exponent 1.5, linear damping: the law itself but for its ramp S.
- Ring pins: `ObjectContactCurveCircles`, one for each disc and pin, of all segments of the edge that can reach the pin
  during the run: each is a linear spring of the bed (see `bed`). A segment is pressed as its nearest point is, so that
  full-length ones would go deeper than the edge (by 10 % of the force with 14 in a contact): they are about a hundredth as
  long as they are apart, and as much stiffer. exudyn multiplies the stiffness by the length, which carries its local factor.
  exudyn looks at each in every stage, so that a run is made of pieces, each of a system that knows the near segments alone.
- The curve contact's damping leaves out the curve's rotation, so it stays off. The external contacts' damping is put where
  it acts: with the edge's normal rate v_n = l_j (disc rate - ideal rate) and C v_n at every loaded pin, the disc feels
  a rotational damper of C times the mean sum of l_j^2 about the ideal speed (l_j: lever of the normal).
Kinematic trees (input with discs, all others by themselves: a short tree makes cheap markers, and a curve contact fails
on a ground marker), Runge-Kutta 4; the driver is a rotor inertia of 1e16 discs. Nothing turns an output pin on its hinge:
its mass is a rotor inertia on the output, and it turns as a tree of its own.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import numpy.typing as npt

from pinwheel_engines.bed import (
    bed_stiffness,
    check_own_contact,
    edge,
    equal_arcs,
    hertz,
    local_stiffness,
    nominal_penetration_m,
    nominal_step_s,
    nominal_width_m,
    springs,
)
from pinwheel_engines.errors import Cancelled, Diverged
from pinwheel_engines.exudyn.session import VERSION, Kept, Load, quiet_session, solve
from pinwheel_engines.guards import Guard
from pinwheel_engines.layout import INPUT, OUTPUT, Kinematics, hole_centres, wheel_phases
from pinwheel_engines.result import Recorder, Result, RunStats
from pinwheel_engines.scene import Scene
from pinwheel_engines.start import initial_angles
from pinwheel_engines.stepping import Stretch, actual_step_s, stretches

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Span = tuple[float, float]

NAME = "exudyn-own-contact"

# Rotor inertia of the driver in moments of inertia of a disc.
DRIVER_WHEELS = 1.0e16
# Least springs along an edge, and within the nominal contact.
SEGMENTS, SEGMENTS_IN_CONTACT = 4000, 7
# Length of a segment of local factor 1 as a share of the distance to the next.
LENGTH = 0.01
# Pieces of a run a turn of the input.
PIECES = 16
# Largest turn of a disc from the ideal mesh: at least this share of half a lobe, its free play so many times and its nominal
# contact's twist so many times.
SHARE_OF_LOBE, PLAYS, TWISTS = 0.03, 2.0, 50.0
# Widths of the nominal contact and arcs of that turn that a pin may touch beside its foot at the ideal mesh.
WIDTHS, AHEAD = 2.0, 2.0


def wheel_damper(scene: Scene) -> float:
    """N m s/rad on a disc's rate against its ideal one: C times the mean over a mesh of the sum of squared levers.

    The lever of pin i is e zs sin(phi_i)/sqrt(1 + m^2 - 2 m cos(phi_i)), and the half of the pins is loaded.
    """
    gear = scene.gear
    phi = (np.arange(2000) + 0.5) * math.pi / 2000
    m = gear.shortening
    lever = gear.eccentricity_m * gear.lobes * np.sin(phi) / np.sqrt(1.0 + m * m - 2.0 * m * np.cos(phi))
    return float(scene.contact.damping_n_s_m * 0.5 * gear.external_sleeves * np.mean(lever**2))


def leeway_rad(scene: Scene) -> float:
    """Returns the angle by which a disc may turn from the ideal mesh, at most half of half a lobe and its free play."""
    gear = scene.gear
    half, lever = math.pi / gear.lobes, gear.eccentricity_m * gear.lobes
    play = (gear.backlash_m + gear.extra_play_m) / lever
    twist = nominal_penetration_m(scene) / lever
    return float(min(max(SHARE_OF_LOBE * half, PLAYS * play + TWISTS * twist), 0.5 * (half + play)))


@dataclass(frozen=True)
class _Edge:
    """The springs of an edge: ends of the segments, m, and the parameters of their middles."""

    starts: Complexes
    ends: Complexes
    parameters: Floats
    # Segments that a pin may touch on either side of its foot at the ideal mesh.
    margin: float

    @staticmethod
    def of(scene: Scene, segments: int) -> _Edge:
        """Makes `count` segments at equal distances."""
        a, spacing = equal_arcs(scene, segments)
        middles = edge(scene, a)
        along = np.roll(middles, -1) - np.roll(middles, 1)
        reach = 0.5 * LENGTH * spacing * local_stiffness(scene, segments) * along / np.abs(along)
        # Contacts in pits are wider than on straight edges, and feet run ahead of a disc's turn.
        margin = WIDTHS * nominal_width_m(scene) + AHEAD * leeway_rad(scene) * scene.gear.pitch_radius_m
        return _Edge(middles - reach, middles + reach, a, margin / spacing)

    def reachable(self, scene: Scene, wheel: int, sleeve: int, span_s: Span) -> npt.NDArray[np.bool_]:
        """Segments within reach of a pin during a span: its foot at the ideal mesh is followed along the edge."""
        gear, count = scene.gear, self.parameters.size
        f = wheel_phases(gear)[wheel] + scene.drive.input_speed_rad_s * np.linspace(*span_s, 200)
        foot = 2.0 * math.pi * sleeve / gear.external_sleeves - (math.pi - f) / gear.lobes
        turns, within = np.divmod(foot, 2.0 * math.pi)
        at = np.interp(within, np.append(self.parameters, 2.0 * math.pi), np.arange(count + 1)) + turns * count
        low, high = float(at.min()) - self.margin, float(at.max()) + self.margin
        return np.asarray(np.mod(np.arange(count) - low, count) <= high - low)


def pieces(parts: list[Stretch], longest_s: float) -> list[Stretch]:
    """Returns the stretches cut at samples, so that none is longer than a sample interval."""
    cut = []
    for part in parts:
        step = (part.end_s - part.start_s) / part.samples
        most = max(1, math.floor(min(longest_s / step, part.samples)))
        ends = [min(k + most, part.samples) for k in range(0, part.samples, most)]
        for first, last in zip([0, *ends], ends, strict=False):
            end_s = part.end_s if last == part.samples else part.start_s + last * step
            cut.append(dataclasses.replace(part, start_s=part.start_s + first * step, end_s=end_s, samples=last - first))
    return cut


class _Machine:
    """The exudyn system of one piece of a run, and how to read its forces."""

    def __init__(self, scene: Scene, edge_of: _Edge, state: tuple[Floats, Floats], span_s: Span) -> None:
        gear = scene.gear
        self.scene, self.edge, self.span_s = scene, edge_of, span_s
        self.load, self.driver_kg_m2 = Load(scene.drive), scene.mass.driver_kg_m2(DRIVER_WHEELS)
        self.kinematics = Kinematics(gear)
        self.layout = self.kinematics.layout
        self.container = exu.SystemContainer()
        self.system = self.container.AddSystem()
        self.ground = self.system.AddObject(items.ObjectGround())
        angles, rates = state
        self.initial_states = self.kinematics.states(angles, rates)
        layout = self.layout
        self.drive_side = [INPUT, *range(layout.wheel_bodies.start, layout.wheel_bodies.stop)]
        relative = self.kinematics.relative(angles), self.kinematics.relative(rates)
        self.drive_tree = self._add_tree(self.drive_side, *relative, self.driver_kg_m2)
        carried = self.kinematics.lumped_moments(scene)[OUTPUT] - scene.mass.output_shaft.moment_kg_m2
        self.load_tree = self._add_tree([OUTPUT], angles, rates, carried)
        self.sleeves = list(range(layout.external_bodies.start, layout.bodies))
        self.sleeve_trees = [self._add_tree([body], angles, rates, 0.0) for body in self.sleeves]
        self._add_dampers()
        self.outer = self._add_edges()
        self.inner = self._add_holes()
        self.system.Assemble()

    def _add_tree(self, bodies: list[int], angles: Floats, rates: Floats, rotor: float) -> Any:
        """A carrier and what it carries, with the angles and rates of its joints; the first of `bodies` is the carrier."""
        kinematics, parts = self.kinematics, self.scene.mass.of_bodies(self.scene.gear)
        count = len(bodies)
        node = self.system.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=[0.0] * count,
                initialCoordinates=angles[bodies].tolist(),
                initialCoordinates_t=rates[bodies].tolist(),
                numberOfODE2Coordinates=count,
            )
        )
        own = [parts[b] for b in bodies]
        moments = [p.moment_kg_m2 for p in own]
        moments[0] += rotor
        offsets = kinematics.offsets[bodies]
        return self.system.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node,
                jointTypes=[exu.JointType.RevoluteZ] * count,
                linkParents=[-1] + [0] * (count - 1),
                jointTransformations=exu.Matrix3DList([np.eye(3)] * count),
                jointOffsets=exu.Vector3DList([[float(z.real), float(z.imag), 0.0] for z in offsets]),
                linkInertiasCOM=exu.Matrix3DList([np.diag([0.0, 0.0, j]) for j in moments]),
                linkCOMs=exu.Vector3DList([[0.0, 0.0, 0.0]] * count),
                linkMasses=[p.mass_kg for p in own],
            )
        )

    def _link_marker(self, tree: Any, link: int, at: complex) -> Any:
        return self.system.AddMarker(
            items.MarkerKinematicTreeRigid(
                objectNumber=tree, linkNumber=link, localPosition=[float(at.real), float(at.imag), 0.0]
            )
        )

    def _ground_marker(self, at: complex) -> Any:
        return self.system.AddMarker(
            items.MarkerBodyRigid(bodyNumber=self.ground, localPosition=[float(at.real), float(at.imag), 0.0])
        )

    def _add_dampers(self) -> None:
        """The external contacts' damping as a damper on every disc, about its ideal speed; and the load."""
        ideal = -self.scene.drive.input_speed_rad_s / self.scene.gear.lobes
        still = self._ground_marker(0j)
        for link in range(1, len(self.drive_side)):
            self.system.AddObject(
                items.ObjectConnectorTorsionalSpringDamper(
                    markerNumbers=[still, self._link_marker(self.drive_tree, link, 0j)],
                    damping=wheel_damper(self.scene),
                    velocityOffset=ideal,
                )
            )
        drive = self.scene.drive
        load: dict[str, Any] = {"loadVector": [0.0, 0.0, drive.output_torque_n_m]}
        if drive.load_varies:
            load["loadVectorUserFunction"] = lambda _system, t, _vector: [0.0, 0.0, self.load.piece.load_n_m(t)]
        self.system.AddLoad(items.LoadTorqueVector(markerNumber=self._link_marker(self.load_tree, 0, 0j), **load))

    def _add_edges(self) -> list[list[Any]]:
        """Curve contacts, one list of discs for every pin."""
        scene, gear, of = self.scene, self.scene.gear, self.edge
        table = np.column_stack([of.starts.real, of.starts.imag, of.ends.real, of.ends.imag])
        stiffness = bed_stiffness(scene) / LENGTH
        contacts: list[list[Any]] = []
        for sleeve in range(gear.external_sleeves):
            seat = self._link_marker(self.sleeve_trees[sleeve], 0, 0j)
            contacts.append([])
            for wheel in range(gear.wheels):
                near = of.reachable(scene, wheel, sleeve, self.span_s)
                contacts[-1].append(self._add_curve(wheel, sleeve, seat, table[near], stiffness))
        return contacts

    def _add_curve(self, wheel: int, sleeve: int, seat: Any, segments: Floats, stiffness: float) -> Any:
        """One curve contact: some segments of a disc's edge against a pin."""
        return self.system.AddObject(
            items.ObjectContactCurveCircles(
                markerNumbers=[self._link_marker(self.drive_tree, 1 + wheel, 0j), seat],
                nodeNumber=self._add_curve_data(segments, wheel, sleeve),
                circlesRadii=[self.scene.gear.external_sleeve_radius_m],
                segmentsData=exu.MatrixContainer(segments.tolist()),
                contactStiffness=stiffness,
                contactDamping=0.0,
                contactModel=0,
            )
        )

    def _add_curve_data(self, segments: Floats, wheel: int, sleeve: int) -> Any:
        """The state of a curve contact at the start: circle (0, or -1 for none), gap and sliding rate of every segment."""
        states = self.initial_states
        body, pin = states[self.layout.wheel_bodies][wheel], states[self.layout.external_bodies][sleeve]
        centre = complex(pin[0] - body[0], pin[1] - body[1]) * np.exp(-1j * body[2])
        start = segments[:, 0] + 1j * segments[:, 1]
        along = segments[:, 2] + 1j * segments[:, 3] - start
        share = np.clip(np.real((centre - start) * np.conj(along)) / np.abs(along) ** 2, 0.0, 1.0)
        gap = np.abs(centre - start - share * along) - self.scene.gear.external_sleeve_radius_m
        table = np.column_stack([np.where(gap < 0.0, 0.0, -1.0), gap, np.zeros_like(gap)])
        return self.system.AddNode(
            items.NodeGenericData(initialCoordinates=table.ravel().tolist(), numberOfDataCoordinates=table.size)
        )

    def _add_holes(self) -> list[list[Any]]:
        """Hollow-sphere contacts, one list of discs for every output pin."""
        scene, gear = self.scene, self.scene.gear
        holes, seats = hole_centres(gear), self.kinematics.offsets[self.layout.internal_bodies]
        stiffness, layout = hertz(scene).hole_stiffness, self.layout
        contacts: list[list[Any]] = []
        for sleeve in range(gear.internal_sleeves):
            seat = self._link_marker(self.load_tree, 0, seats[sleeve])
            contacts.append([])
            for wheel in range(gear.wheels):
                w, s = self.initial_states[layout.wheel_bodies][wheel], self.initial_states[layout.internal_bodies][sleeve]
                hole = complex(w[0], w[1]) + holes[wheel, sleeve] * np.exp(1j * w[2])
                gap = gear.hole_radius_m - gear.internal_sleeve_radius_m - abs(complex(s[0], s[1]) - hole)
                data = self.system.AddNode(
                    items.NodeGenericData(initialCoordinates=[gap, 0.0, 0.0, 0.0], numberOfDataCoordinates=4)
                )
                contacts[-1].append(
                    self.system.AddObject(
                        items.ObjectContactSphereSphere(
                            markerNumbers=[seat, self._link_marker(self.drive_tree, 1 + wheel, holes[wheel, sleeve])],
                            nodeNumber=data,
                            spheresRadii=[gear.internal_sleeve_radius_m, gear.hole_radius_m],
                            isHollowSphere1=True,
                            dynamicFriction=0.0,
                            contactStiffness=stiffness,
                            contactStiffnessExponent=1.5,
                            contactDamping=scene.contact.damping_n_s_m,
                            impactModel=0,
                        )
                    )
                )
        return contacts

    def absolute(self) -> tuple[Floats, Floats]:
        """Absolute angles and rates of all bodies."""
        order, wheels = [*self.drive_side, OUTPUT, *self.sleeves], self.layout.wheel_bodies
        data = self.system.systemData
        absolute = np.zeros((2, self.layout.bodies))
        absolute[:, order] = data.GetODE2Coordinates(), data.GetODE2Coordinates_t()
        absolute[:, wheels] += absolute[:, INPUT : INPUT + 1]
        return absolute[0], absolute[1]

    def forces(self, angles: Floats) -> tuple[Complexes, Complexes]:
        """Contact force on every ring and output pin, vector sums over the discs, N, ground frame."""
        gear, system, kinds = self.scene.gear, self.system, exu.OutputVariableType
        turns = np.exp(1j * angles[self.layout.wheel_bodies])
        # x and y of every segment's force in the disc's frame, with the sign of the equations' left-hand side.
        parts = [system.GetObjectOutput(contact, kinds.ForceLocal) for contacts in self.outer for contact in contacts]
        starts = np.cumsum([0] + [len(part) // 2 for part in parts[:-1]])
        local = np.add.reduceat(np.concatenate(parts).view(np.complex128), starts)
        outer = -local.reshape(gear.external_sleeves, gear.wheels) @ turns
        inner = np.zeros(gear.internal_sleeves, dtype=np.complex128)
        for sleeve, contacts in enumerate(self.inner):
            for contact in contacts:
                x, y, _ = system.GetObjectOutput(contact, kinds.Force)
                inner[sleeve] += complex(x, y)
        return outer, inner

    def driver_torque(self) -> float:
        """Torque of the driver on the input shaft, N m."""
        return -self.driver_kg_m2 * float(self.system.systemData.GetODE2Coordinates_tt()[0])


def run(
    scene: Scene,
    on_progress: Callable[[float], bool] | None = None,
    step_s: float | None = None,
    initial: Floats | None = None,
    segments: int | None = None,
) -> Result:
    """Runs a scene without friction. `segments`: springs along each disc's edge, by default as many as it needs.

    `step_s`: by default `bed.nominal_step_s`.
    Raises Diverged with the courses until then, Cancelled, EngineFailed, Unsupported.
    """
    check_own_contact(NAME, scene)
    segments = segments or springs(scene, SEGMENTS, SEGMENTS_IN_CONTACT)
    guard = Guard(NAME, scene)
    # Beyond this angle a disc would leave the segments of its piece.
    guard.wheel_limit_rad = min(guard.wheel_limit_rad, leeway_rad(scene))
    wanted = nominal_step_s(scene) if step_s is None else step_s
    kept = Kept()
    wall, cpu = time.perf_counter(), time.thread_time()
    progress = {"steps": 0}
    with quiet_session():
        springs_of = _Edge.of(scene, segments)
        kinematics = Kinematics(scene.gear)
        layout, recorder = kinematics.layout, Recorder(scene, kinematics)
        speed = abs(scene.drive.input_speed_rad_s)
        longest_s = 2.0 * math.pi / (PIECES * speed) if speed > 0.0 else math.inf
        parts = pieces(stretches(recorder.times_s, wanted, scene.drive.load_breaks_s), longest_s)
        spans = [(part.start_s, part.end_s) for part in parts] or [(0.0, 0.0)]
        machine = _Machine(scene, springs_of, initial_angles(scene, initial), spans[0])

        def sample(time_s: float) -> None:
            angles, rates = machine.absolute()
            guard.check_states(time_s, angles, rates)
            outer, inner = machine.forces(angles)
            forces = np.abs(np.concatenate([outer, inner]))
            guard.check_forces(time_s, forces)
            torque = machine.driver_torque()
            recorder.record_forces(
                torque,
                kinematics.torque_of_pins(angles[OUTPUT], outer, inner),
                float(angles[OUTPUT]),
                forces,
            )
            if on_progress is not None and on_progress(time_s):
                raise Cancelled

        def adjust(settings: Any) -> None:
            # The step that exudyn recommends after a change of contact would shrink to 0.
            settings.timeIntegration.discontinuous.useRecommendedStepSize = False

        def finish() -> Result:
            stats = RunStats(
                wall_s=time.perf_counter() - wall,
                cpu_s=time.thread_time() - cpu,
                steps=progress["steps"],
                degrees_of_freedom=layout.bodies,
                bodies=layout.bodies,
                step_s=actual_step_s(recorder.times_s, wanted),
                settings=f"KinematicTree, RK44, {segments} segments an edge, disc damper {wheel_damper(scene):.4g} "
                "N m s/rad for the external contacts' damping",
                versions={"exudyn": VERSION, "numpy": np.__version__},
                notes=["the ramp S of the contact law and contact.detection have no counterpart in exudyn's contacts"],
            )
            return Result(NAME, recorder.columns(), stats)

        try:
            sample(0.0)
            for part, span_s in zip(parts, spans, strict=False):
                if span_s != spans[0]:
                    machine = _Machine(scene, springs_of, machine.absolute(), span_s)
                solver, begin = exu.DynamicSolverType.RK44, machine.load.begin
                progress["steps"] += solve(NAME, machine.system, [part], kept, solver, sample, adjust, begin)
        except Diverged as error:
            error.partial = finish()
            raise
        return finish()
