"""exudyn, shared law, constrained: 28 free bodies, 29 joints, Lagrange multipliers, an implicit second-order method.

The closest relative of the published formulation: three coordinates a body, revolute joints and a driver as constraints
(Eq. 2-8). Contact loads enter as the force of one generic object over all bodies, evaluated in every Newton iteration.
The Newton matrix needs the contact forces only where they are stiff over a step. Normal forces converge without
(contraction about h^2 omega^2/4, 1e-3 at 1e-5 s). Friction needs its velocities, and its true derivative sends Newton in
circles between sticking and sliding: the slope mu F_n/max(v_s, |v_t|) of the secant through the origin is given instead,
which turns the iteration into reweighted least squares; that descends on the convex problem a friction step is. Sleeves
that rub on their pins are given likewise.
The driver's multiplier is minus the torque it exerts on the input shaft.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import numpy.typing as npt

from pinwheel_engines.border import LawPointer, StageLaw, check_bearings, check_not_frozen
from pinwheel_engines.errors import Cancelled, Diverged
from pinwheel_engines.exudyn.session import VERSION, Coordinates, Kept, Load, quiet_session, solve
from pinwheel_engines.guards import Guard
from pinwheel_engines.law import LAWS, ContactLaw
from pinwheel_engines.layout import INPUT, OUTPUT, Kinematics
from pinwheel_engines.result import Recorder, Result, RunStats
from pinwheel_engines.scene import Scene
from pinwheel_engines.start import initial_angles, initial_states
from pinwheel_engines.stepping import actual_step_s, stretches

Floats = npt.NDArray[np.float64]

NAME = "exudyn-shared-law-constrained"

# A sleeve that rolls slower rubs less on its pin.
SLOW_RAD_S = 1.0

# Names of the integrators in a scene.
INTEGRATORS = ("trapezoidal-index2", "generalized-alpha")


def run(
    scene: Scene,
    law: LawPointer | None = None,
    on_progress: Callable[[float], bool] | None = None,
    step_s: float | None = None,
    initial: Floats | None = None,
    integrator: str = "trapezoidal-index2",
) -> Result:
    """Runs a scene. `step_s` overrides the scene's step; `on_progress` gets simulated seconds, True stops the run.

    Raises Diverged with the courses until then, FrozenForces, Cancelled, EngineFailed, Unsupported.
    """
    wanted = scene.solver.step_s if step_s is None else step_s
    check_bearings(NAME, scene, law)
    kinematics = Kinematics(scene.gear)
    held = _held(scene, kinematics)
    stage_law = StageLaw(scene, law)
    guard = Guard(NAME, scene)
    recorder = Recorder(scene, kinematics)
    kept = Kept()
    load = Load(scene.drive)
    wall, cpu = time.perf_counter(), time.thread_time()
    progress = {"steps": 0}
    drift = {"m": 0.0}
    count = kinematics.layout.bodies
    coordinates = Coordinates(3 * count)
    by_body = coordinates.values.reshape(2, count, 3).transpose(1, 0, 2)

    def force(_system: Any, time_s: float, _item: int, q: Any, q_t: Any) -> list[float]:
        coordinates.take(q, q_t)
        stage_law.states.reshape(count, 2, 3)[:] = by_body
        # exudyn reads a list faster than an array.
        loads: list[float] = stage_law.evaluate(time_s).ravel().tolist()
        loads[3 * OUTPUT + 2] += load.piece.load_n_m(time_s)
        return loads

    jacobian = _jacobian(scene, count)
    with quiet_session():
        container = exu.SystemContainer()
        system = container.AddSystem()
        zeros = np.zeros(3 * count)
        driver = _add_mechanism(
            system,
            scene,
            kinematics,
            initial_states(scene, initial),
            initial_angles(scene, initial),
            kept.function(force, zeros),
            kept.function(jacobian, np.zeros((zeros.size, zeros.size))),
        )
        system.Assemble()

        def sample(time_s: float) -> None:
            data = system.systemData
            q, q_t = data.GetODE2Coordinates().reshape(count, 3), data.GetODE2Coordinates_t().reshape(count, 3)
            guard.check_states(time_s, q[:, 2], q_t[:, 2])
            pinned = kinematics.states(q[:, 2], q_t[:, 2])
            drift["m"] = max(drift["m"], float(np.max(np.abs(pinned[held, :2] - q[held, :2]))))
            stage_law.states[:, :3], stage_law.states[:, 3:] = q, q_t
            loads = stage_law.evaluate_at(time_s)
            guard.check_forces(time_s, loads[:, :2])
            torque = -float(system.GetObjectOutput(driver, exu.OutputVariableType.Force))
            if time_s == 0.0:
                # No multipliers before the first step: the torque that holds the input's speed.
                torque = -float(loads[INPUT, 2] if scene.floats else kinematics.torques(q[:, 2], loads)[INPUT])
            guard.check_forces(time_s, np.array([torque]), "driver torque")
            recorder.record(stage_law.states, loads, torque)
            if on_progress is not None and on_progress(time_s):
                raise Cancelled

        def adjust(settings: Any) -> None:
            # The matrix is renewed only when an iteration gains less than a factor of two. Light pins take some 30
            # iterations a step on average and hundreds in single ones.
            newton = settings.timeIntegration.newton
            newton.useModifiedNewton, newton.maxIterations = True, 2000
            settings.linearSolver.solverType = exu.LinearSolverType.EigenDense

        def finish() -> Result:
            stats = RunStats(
                wall_s=time.perf_counter() - wall,
                cpu_s=time.thread_time() - cpu,
                rhs_calls=stage_law.calls,
                steps=progress["steps"],
                degrees_of_freedom=3 * count,
                bodies=count,
                step_s=actual_step_s(recorder.times_s, wanted),
                settings=f"{count} RigidBody2D, {len(held)} JointRevolute2D, driver constraint, {integrator}, "
                f"{stage_law.name}",
                joint_drift_m=drift["m"],
                versions={"exudyn": VERSION, "numpy": np.__version__},
            )
            return Result(NAME, recorder.columns(), stats)

        solvers = exu.DynamicSolverType
        solver = solvers.TrapezoidalIndex2 if integrator == INTEGRATORS[0] else solvers.GeneralizedAlpha
        try:
            sample(0.0)
            parts = stretches(recorder.times_s, wanted, scene.drive.load_breaks_s)
            progress["steps"] = solve(NAME, system, parts, kept, solver, sample, adjust, load.begin)
            # One evaluation a step is the least an implicit method can do.
            check_not_frozen(NAME, progress["steps"], 1, stage_law.calls, stage_law.changes)
        except Diverged as error:
            error.partial = finish()
            raise
        return finish()


def _add_mechanism(
    system: Any,
    scene: Scene,
    kinematics: Kinematics,
    states: Floats,
    start: tuple[Floats, Floats],
    force: Callable[..., Any],
    jacobian: Callable[..., Any],
) -> Any:
    """Bodies, joints, driver and the contact object; returns the driver's object number."""
    layout = kinematics.layout
    parts = scene.mass.of_bodies(scene.gear)
    ground = system.AddObject(items.ObjectGround())
    nodes, bodies = [], []
    for part, state in zip(parts, states, strict=True):
        # Reference coordinates stay 0, so that no user function has to know whether it sees them.
        nodes.append(
            system.AddNode(
                items.NodeRigidBody2D(initialCoordinates=state[:3].tolist(), initialVelocities=state[3:].tolist())
            )
        )
        bodies.append(
            system.AddObject(items.ObjectRigidBody2D(mass=part.mass_kg, inertia=part.moment_kg_m2, nodeNumber=nodes[-1]))
        )
    for index in _held(scene, kinematics):
        carrier = layout.carriers[index]
        at = kinematics.offsets[index]
        seat = [float(at.real), float(at.imag), 0.0]
        carrier_object = ground if carrier < 0 else bodies[carrier]
        system.AddObject(
            items.ObjectJointRevolute2D(
                markerNumbers=[
                    system.AddMarker(items.MarkerBodyPosition(bodyNumber=carrier_object, localPosition=seat)),
                    system.AddMarker(items.MarkerBodyPosition(bodyNumber=bodies[index], localPosition=[0.0, 0.0, 0.0])),
                ]
            )
        )
    omega, phase = float(start[1][0]), float(start[0][0])
    still = system.AddNode(items.NodePointGround(referenceCoordinates=[0.0, 0.0, 0.0]))
    driver = system.AddObject(
        items.ObjectConnectorCoordinate(
            markerNumbers=[
                system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=still, coordinate=0)),
                system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=2)),
            ],
            offsetUserFunction=lambda _system, t, _item, _offset: phase + omega * t,
            offsetUserFunction_t=lambda _system, _t, _item, _offset: omega,
        )
    )
    system.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=nodes,
            massMatrix=np.zeros((3 * len(nodes), 3 * len(nodes))),
            forceUserFunction=force,
            jacobianUserFunction=jacobian,
        )
    )
    return driver


def _held(scene: Scene, kinematics: Kinematics) -> list[int]:
    """The bodies that a revolute holds: all but discs that float."""
    layout = kinematics.layout
    wheels = range(layout.bodies)[layout.wheel_bodies] if scene.floats else range(0)
    return [body for body in range(layout.bodies) if body not in wheels]


def _jacobian(scene: Scene, count: int) -> Callable[..., Floats]:
    """The contact object's user Jacobian: minus the derivative of its force, friction's velocities only."""
    size = 3 * count
    own, on_pin = scene.contact.friction_coefficient, scene.sleeve_friction_coefficient
    # Sleeves with a stated friction roll; on other pins the disc slides.
    rolls = np.array([on_pin > 0.0 and turns for turns in scene.gear.sleeves_turn])
    if own == 0.0 and not rolls.any():
        nothing = np.zeros((size, size))
        return lambda *_arguments: nothing
    # Friction has this form under every law. For laws without a numpy version the paper's law is accurate enough for a
    # Newton matrix.
    contact = scene.contact
    known = contact.law if contact.law in LAWS else "paper"
    law = ContactLaw(scene.with_keys("contact", law=known, friction_law="regularised", detection="exact"))
    # Cranks roll in their bores.
    rubbing = count if scene.gear.eccentric_per_input == 1.0 else law.layout.internal_bodies.start
    carriers = np.array(law.layout.carriers)
    sleeves = slice(law.layout.external_bodies.start, count)
    is_output_pin = np.arange(count) >= law.layout.internal_bodies.start
    rolling = rolls[is_output_pin.astype(int)]
    held = ~np.array(scene.gear.sleeves_turn)[is_output_pin.astype(int)]
    # Body that moves the rubbing side of a sleeve: the sleeve itself, or the body that holds its pin.
    turned_by = np.where(rolling | held, carriers, np.arange(count))

    def friction(
        _system: Any, _time: float, _item: int, q: Floats, q_t: Floats, _f_position: float, f_velocity: float
    ) -> Floats:
        states = np.hstack([np.asarray(q).reshape(count, 3), np.asarray(q_t).reshape(count, 3)])
        by = turned_by[sleeves]
        states[sleeves, 5] = np.where(by < 0, 0.0, states[by, 5])
        pairs = law.contacts(states[None])
        speed = np.abs(pairs.tangential_rate_m_s)
        share = own / np.maximum(speed, contact.friction_ramp_m_s)
        if rolls.any():
            radius = np.abs(pairs.point_m - (states[pairs.sleeve, 0] + 1j * states[pairs.sleeve, 1]))
            turning = on_pin * np.minimum(0.5 * scene.sleeve_bore_m / radius, 1.0)
            turning /= np.maximum(speed, radius * SLOW_RAD_S)
            # Rolling and sliding compete: the smaller moment acts.
            smaller = np.minimum(turning, share) if own > 0.0 else turning
            share = np.where(rolling[pairs.sleeve], smaller, share)
        slope = np.where(pairs.sleeve < rubbing, share * pairs.normal_force_n, 0.0)
        tangent = 1j * pairs.normal
        # v_t = rows . velocities, one row a pair: the pin's part and the disc's.
        rows = np.zeros((slope.size, size))
        pair = np.arange(slope.size)
        for body, turned, sign in ((pairs.sleeve, turned_by[pairs.sleeve], 1.0), (pairs.wheel, pairs.wheel, -1.0)):
            arm = pairs.point_m - (states[body, 0] + 1j * states[body, 1])
            rows[pair, 3 * body] = sign * tangent.real
            rows[pair, 3 * body + 1] = sign * tangent.imag
            moves = turned >= 0
            rows[pair[moves], 3 * turned[moves] + 2] = sign * np.imag(np.conj(arm) * tangent)[moves]
        return np.asarray(f_velocity * (rows.T * slope) @ rows)

    return friction
