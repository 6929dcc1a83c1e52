"""MuJoCo, shared law: 28 hinges as a tree, RK4, contact torques in every stage through `mjcb_passive`.

MuJoCo supplies bodies, joints, the mass matrix and the integration; its own contact is off. Joint angles are relative to
the carrier. The driver is a rotor inertia (armature) of 1e16 discs on the input hinge: it holds the speed to some parts in
1e15 and its own deceleration tells the driver's torque, -armature * acceleration. After an RK4 step MuJoCo's
accelerations belong to the fourth stage, so each sample is taken from a forward evaluation at the sample's own state.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import mujoco
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
from pinwheel_engines.errors import Cancelled, Diverged, EngineFailed
from pinwheel_engines.guards import Guard
from pinwheel_engines.layout import INPUT, OUTPUT, Kinematics
from pinwheel_engines.mujoco.model import coordinates, slides, tree_xml
from pinwheel_engines.mujoco.session import VERSION, Callback, check_data, quiet_session
from pinwheel_engines.result import Recorder, Result, RunStats
from pinwheel_engines.scene import Scene
from pinwheel_engines.start import initial_states
from pinwheel_engines.stepping import actual_step_s, legs, steps_between

Floats = npt.NDArray[np.float64]

NAME = "mujoco-shared-law"

# Rotor inertia of the driver in moments of inertia of a disc.
DRIVER_WHEELS = 1.0e16


def model_xml(scene: Scene, step_s: float) -> str:
    """The mechanism as MJCF, contact and constraints off."""
    return (
        f'<mujoco><option integrator="RK4" timestep="{step_s!r}" gravity="0 0 0">'
        '<flag contact="disable" constraint="disable" autoreset="disable"/></option>'
        f"<worldbody>{tree_xml(scene, scene.mass.driver_kg_m2(DRIVER_WHEELS))}</worldbody></mujoco>"
    )


class _Machine:
    """Model, data and the contact torques of one run."""

    def __init__(self, scene: Scene, step_s: float, law: StageLaw, initial: Floats | None) -> None:
        self.scene, self.law, self.driver_kg_m2 = scene, law, scene.mass.driver_kg_m2(DRIVER_WHEELS)
        self.kinematics = Kinematics(scene.gear, scene.floats)
        self.model = mujoco.MjModel.from_xml_string(model_xml(scene, step_s))
        self.data = mujoco.MjData(self.model)
        self.coordinate = coordinates(self.kinematics, self.model)
        self.slides, self.wheels = slides(scene, self.model), self.kinematics.layout.wheel_bodies
        states = initial_states(scene, initial)
        self.data.qpos[self.coordinate] = self.kinematics.relative(states[:, 2])
        self.data.qvel[self.coordinate] = self.kinematics.relative(states[:, 5])
        if scene.floats:
            self.data.qpos[self.slides], self.data.qvel[self.slides] = states[self.wheels, :2], states[self.wheels, 3:5]
        # The load is set by a callback if it varies, else once.
        self.load_address = int(self.coordinate[OUTPUT])
        self.load = scene.drive.load_piece(0.0)
        self.data.qfrc_applied[self.load_address] = self.load.load_n_m(0.0)
        self.body = np.array([self.model.body(f"b{i}").id for i in range(self.coordinate.size)], dtype=np.intp)

    def absolute(self) -> tuple[Floats, Floats]:
        """Absolute angles and rates of all bodies."""
        kinematics, data = self.kinematics, self.data
        return kinematics.absolute(data.qpos[self.coordinate]), kinematics.absolute(data.qvel[self.coordinate])

    def set_states(self, angles: Floats, rates: Floats) -> None:
        """Copies MuJoCo's state into the law's states."""
        states, data = self.law.states, self.data
        self.kinematics.states(angles, rates, out=states)
        if self.scene.floats:
            states[self.wheels, :2], states[self.wheels, 3:5] = data.qpos[self.slides], data.qvel[self.slides]

    def add_contact_torques(self) -> None:
        """Body of the passive-force callback without a compiled one."""
        angles, rates = self.absolute()
        self.set_states(angles, rates)
        loads = self.law.evaluate(self.data.time)
        self.data.qfrc_passive[self.coordinate] += self.kinematics.relative_torques(angles, loads)
        if self.scene.floats:
            self.data.qfrc_passive[self.slides] += loads[self.wheels, :2]

    def set_load(self) -> None:
        """The body of the control callback of a load that varies: in every stage the load of the step's own side."""
        self.data.qfrc_applied[self.load_address] = self.load.load_n_m(self.data.time)

    def driver_torque(self) -> float:
        """Torque of the driver on the input shaft at the state of the last forward evaluation, N m."""
        return -self.driver_kg_m2 * float(self.data.qacc[self.coordinate[INPUT]])

    def check_kinematics(self, states: Floats) -> None:
        """Raises EngineFailed unless MuJoCo's own body positions agree with the states that the law is given."""
        apart = np.max(np.abs(self.data.xipos[self.body, :2] - states[:, :2]))
        # Positions are products of a few rotations: some units in the last place of the gear's size.
        if not apart < 2e-11 * self.scene.gear.pitch_radius_m:
            raise EngineFailed(NAME, f"MuJoCo's body positions differ by {apart:.3g} m from those given to the law")


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
    stage_law = StageLaw(scene, law)
    guard = Guard(NAME, scene)
    wall, cpu = time.perf_counter(), time.thread_time()
    with quiet_session():
        machine = _Machine(scene, wanted, stage_law, initial)
        model, data = machine.model, machine.data
        passive = Callback(machine.add_contact_torques)
        arrays = (data.qpos, data.qvel, data.qfrc_passive)
        layout = joint_layout(machine.kinematics, machine.coordinate, int(data._address), *arrays)
        address = attached(scene, law, layout)
        mujoco.set_mjcb_passive(passive.pointer if address is None else CALLBACK_TYPE(address))
        control = Callback(machine.set_load)
        if scene.drive.load_varies:
            mujoco.set_mjcb_control(control.pointer)
        else:
            mujoco.set_mjcb_control(None)
        recorder = Recorder(scene, machine.kinematics)
        times, breaks = recorder.times_s, scene.drive.load_breaks_s
        steps = 0

        def counts() -> tuple[int, int]:
            counters = layout["counters_array"]
            # One call a sample is the forward evaluation that the sample is taken from.
            calls = stage_law.calls + int(counters[0]) - recorder.count
            return max(0, calls), stage_law.changes + int(counters[1])

        def finish() -> Result:
            stats = RunStats(
                wall_s=time.perf_counter() - wall,
                cpu_s=time.thread_time() - cpu,
                rhs_calls=counts()[0],
                steps=steps,
                degrees_of_freedom=int(model.nv),
                bodies=machine.kinematics.layout.bodies,
                step_s=actual_step_s(recorder.times_s, wanted),
                settings=f"RK4, {stage_law.name}{'' if address is None else ' called directly'}, "
                f"driver as armature {machine.driver_kg_m2:g} kg m^2",
                versions={"mujoco": VERSION, "numpy": np.__version__},
            )
            return Result(NAME, recorder.columns(), stats)

        try:
            for k, instant in enumerate(times):
                if k > 0:
                    for start, end in legs(float(times[k - 1]), float(instant), breaks, wanted):
                        machine.load = scene.drive.load_piece(0.5 * (start + end))
                        count, model.opt.timestep = steps_between(start, end, wanted)
                        data.time = start
                        mujoco.mj_step(model, data, count)
                        steps += count
                    passive.raise_kept()
                    control.raise_kept()
                    check_data(guard, data, float(instant))
                mujoco.mj_forward(model, data)
                passive.raise_kept()
                angles, rates = machine.absolute()
                guard.check_states(float(instant), angles, rates)
                machine.set_states(angles, rates)
                machine.check_kinematics(stage_law.states)
                loads = stage_law.evaluate_at(float(instant))
                guard.check_forces(float(instant), loads[:, :2])
                recorder.record(stage_law.states, loads, machine.driver_torque())
                if on_progress is not None and on_progress(float(instant)):
                    raise Cancelled
            calls, changes = counts()
            check_not_frozen(NAME, steps, 4, calls, changes)
        except Diverged as error:
            error.partial = finish()
            raise
        finally:
            mujoco.set_mjcb_passive(None)
            detach(law)
        return finish()
