"""exudyn, shared law, explicit: one kinematic tree of revolute joints, classical Runge-Kutta of order 4.

exudyn supplies the tree's mass matrix and the integration; contact torques enter through the tree's force user function,
which runs in every stage. Explicit solvers of exudyn ignore constraints, so the driver is a rotor inertia of 1e16 discs
on the input link and its torque is -inertia * acceleration, from the acceleration at the end of the step.
The user function's coordinates include the reference coordinates, which are 0 here.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import numpy.typing as npt

from pinwheel_engines.border import (
    CALLBACK_TYPE,
    LawPointer,
    StageLaw,
    attached,
    check_bearings,
    check_not_frozen,
    detach,
    joint_layout,
)
from pinwheel_engines.errors import Cancelled, Diverged
from pinwheel_engines.exudyn.session import VERSION, Coordinates, Kept, Load, quiet_session, solve
from pinwheel_engines.guards import Guard
from pinwheel_engines.layout import INPUT, OUTPUT, Kinematics
from pinwheel_engines.result import Recorder, Result, RunStats
from pinwheel_engines.scene import Scene
from pinwheel_engines.start import initial_states
from pinwheel_engines.stepping import actual_step_s, stretches

Floats = npt.NDArray[np.float64]

NAME = "exudyn-shared-law-explicit"

# Rotor inertia of the driver in moments of inertia of a disc.
DRIVER_WHEELS = 1.0e16


def run(
    scene: Scene,
    law: LawPointer | None = None,
    on_progress: Callable[[float], bool] | None = None,
    step_s: float | None = None,
    initial: Floats | None = None,
) -> Result:
    """Runs a scene. `step_s` overrides the scene's step; `on_progress` gets simulated seconds, True stops the run.

    Raises Diverged with the courses until then, FrozenForces, Cancelled, EngineFailed, Unsupported.
    """
    wanted = scene.solver.step_s if step_s is None else step_s
    check_bearings(NAME, scene, law)
    kinematics = Kinematics(scene.gear, scene.floats)
    wheels = kinematics.layout.wheel_bodies
    # Slides of discs that float, x and y of each in turn, come before all revolute joints.
    sliding = 2 * scene.gear.wheels if scene.floats else 0
    stage_law = StageLaw(scene, law)
    guard = Guard(NAME, scene)
    recorder = Recorder(scene, kinematics)
    kept = Kept()
    load, driver_kg_m2 = Load(scene.drive), scene.mass.driver_kg_m2(DRIVER_WHEELS)
    wall, cpu = time.perf_counter(), time.thread_time()
    progress = {"steps": 0}

    def force(_system: Any, time_s: float, _item: int, q: Floats, q_t: Floats) -> Floats:
        angles, _ = set_states(q, q_t)
        loads = stage_law.evaluate(time_s)
        torques = kinematics.relative_torques(angles, loads)
        torques[OUTPUT] += load.piece.load_n_m(time_s)
        return np.concatenate([loads[wheels, :2].ravel(), torques]) if sliding else torques

    def set_states(q: Any, q_t: Any) -> tuple[Floats, Floats]:
        """Copies exudyn's state, absolute angles and rates, into the law's states."""
        places, velocities = np.asarray(q), np.asarray(q_t)
        angles, rates = kinematics.absolute(places[sliding:]), kinematics.absolute(velocities[sliding:])
        states = kinematics.states(angles, rates, out=stage_law.states)
        if sliding:
            states[wheels, :2] = places[:sliding].reshape(-1, 2)
            states[wheels, 3:5] = velocities[:sliding].reshape(-1, 2)
        return angles, rates

    count = kinematics.layout.bodies + sliding
    # Hinges alone, with a compiled law: Python copies numbers and computes nothing.
    hinges, torques = Coordinates(count), np.zeros(count)
    data, (angles, rates) = int(torques.ctypes.data), hinges.values
    layout = joint_layout(kinematics, np.arange(count), data, angles, rates, torques)
    address = attached(scene, law, layout)
    add_torques = CALLBACK_TYPE(address or 0)

    def force_directly(_system: Any, time_s: float, _item: int, q: Any, q_t: Any) -> list[float]:
        hinges.take(q, q_t)
        torques.fill(0.0)
        torques[OUTPUT] = load.piece.load_n_m(time_s)
        add_torques(None, data)
        # exudyn reads a list faster than an array.
        return torques.tolist()

    def counts() -> tuple[int, int]:
        calls, changes = layout["counters_array"].tolist()
        return stage_law.calls + calls, stage_law.changes + changes

    with quiet_session():
        container = exu.SystemContainer()
        system = container.AddSystem()
        states = initial_states(scene, initial)

        def joints(place: slice, angle: int) -> list[float]:
            slides = states[wheels, place].ravel()[:sliding]
            return [*slides.tolist(), *kinematics.relative(states[:, angle]).tolist()]

        node = system.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=[0.0] * count,
                initialCoordinates=joints(np.s_[:2], 2),
                initialCoordinates_t=joints(np.s_[3:5], 5),
                numberOfODE2Coordinates=count,
            )
        )
        function = kept.function(force if address is None else force_directly, np.zeros(count))
        _add_tree(system, scene, kinematics, node, function)
        system.Assemble()

        def sample(time_s: float) -> None:
            data = system.systemData
            angles, rates = set_states(data.GetODE2Coordinates(), data.GetODE2Coordinates_t())
            guard.check_states(time_s, angles, rates)
            loads = stage_law.evaluate_at(time_s)
            guard.check_forces(time_s, loads[:, :2])
            torque = -driver_kg_m2 * float(data.GetODE2Coordinates_tt()[sliding + INPUT])
            if time_s == 0.0:
                # exudyn has no accelerations before its first step: the torque that holds the input's speed.
                torque = -float(kinematics.torques(angles, loads)[INPUT])
            recorder.record(stage_law.states, loads, torque)
            if on_progress is not None and on_progress(time_s):
                raise Cancelled

        def finish() -> Result:
            stats = RunStats(
                wall_s=time.perf_counter() - wall,
                cpu_s=time.thread_time() - cpu,
                rhs_calls=counts()[0],
                steps=progress["steps"],
                degrees_of_freedom=count,
                bodies=count,
                step_s=actual_step_s(recorder.times_s, wanted),
                settings=f"KinematicTree, RK44, {stage_law.name}{'' if address is None else ' called directly'}, "
                f"driver as rotor inertia {driver_kg_m2:g} kg m^2",
                versions={"exudyn": VERSION, "numpy": np.__version__},
            )
            return Result(NAME, recorder.columns(), stats)

        try:
            sample(0.0)
            parts = stretches(recorder.times_s, wanted, scene.drive.load_breaks_s)
            solver = exu.DynamicSolverType.RK44
            progress["steps"] = solve(NAME, system, parts, kept, solver, sample, begin=load.begin)
            # Four stages; the evaluation at the end of a step serves the next one's acceleration as well.
            check_not_frozen(NAME, progress["steps"], 4, *counts())
        except Diverged as error:
            error.partial = finish()
            raise
        finally:
            detach(law)
        return finish()


def _add_tree(system: Any, scene: Scene, kinematics: Kinematics, node: Any, force: Callable[..., Any]) -> None:
    """The mechanism as one kinematic tree: massless slides of discs that float, then links in the order of `layout`."""
    layout = kinematics.layout
    sliding = 2 * layout.wheels if kinematics.floats else 0
    offsets = kinematics.offsets.copy()
    parents = [-1 if carrier < 0 else sliding + carrier for carrier in kinematics.carriers.tolist()]
    if sliding:
        parents[layout.wheel_bodies] = range(1, sliding, 2)
        offsets[layout.wheel_bodies] = 0.0
    slides = [link - 1 if link % 2 else -1 for link in range(sliding)]
    parts = scene.mass.of_bodies(scene.gear)
    unit = np.eye(3)
    inertias = [np.diag([0.0, 0.0, part.moment_kg_m2]) for part in parts]
    inertias[INPUT] = np.diag([0.0, 0.0, scene.mass.driver_kg_m2(DRIVER_WHEELS) + parts[INPUT].moment_kg_m2])
    count, none = sliding + layout.bodies, [0.0, 0.0, 0.0]
    system.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.PrismaticX, exu.JointType.PrismaticY] * (sliding // 2)
            + [exu.JointType.RevoluteZ] * layout.bodies,
            linkParents=slides + parents,
            jointTransformations=exu.Matrix3DList([unit] * count),
            jointOffsets=exu.Vector3DList([none] * sliding + [[float(z.real), float(z.imag), 0.0] for z in offsets]),
            linkInertiasCOM=exu.Matrix3DList([np.zeros((3, 3))] * sliding + inertias),
            linkCOMs=exu.Vector3DList([none] * count),
            linkMasses=[0.0] * sliding + [part.mass_kg for part in parts],
            forceUserFunction=force,
        )
    )
