"""Result of a run: the contract's columns at the scene's sample times, and the costs."""

from __future__ import annotations

import csv
import dataclasses
import io
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
import numpy.typing as npt

from pinwheel_engines.layout import OUTPUT, Kinematics, Layout
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]


@dataclass
class RunStats:
    """Cost and settings of one run; the keys are those of the program's `run.json`."""

    wall_s: float = 0.0
    cpu_s: float = 0.0
    """CPU time of the running thread, s."""
    rhs_calls: int = 0
    """Evaluations of the contact forces inside the integration; those of the samples are not counted."""
    steps: int = 0
    rejected_steps: int = 0
    degrees_of_freedom: int = 0
    """Velocities that the engine integrates."""
    bodies: int = 0
    step_s: float = 0.0
    settings: str = ""
    """The engine's own settings in words."""
    joint_drift_m: float | None = None
    """Largest position error of any joint at the samples, where the engine has constraints."""
    versions: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return dataclasses.asdict(self)


@dataclass
class Result:
    """A finished run, or the part of one before it diverged."""

    engine: str
    columns: dict[str, Floats]
    stats: RunStats

    def to_csv(self) -> str:
        """The courses as CSV: header row, `.` decimals, numbers that read back bit for bit."""
        sink = io.StringIO()
        writer = csv.writer(sink, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(zip(*(map(float, column) for column in self.columns.values()), strict=True))
        return sink.getvalue()


def column_names(scene: Scene) -> list[str]:
    """The contract's columns of a scene, in order."""
    names = ["time_s", "input_torque_n_m", "output_torque_n_m", "output_angle_rad"]
    names += [f"external_sleeve_force_n_{j}" for j in range(scene.gear.external_sleeves)]
    names += [f"internal_sleeve_force_n_{k}" for k in range(scene.gear.internal_sleeves)]
    return names


def state_columns(layout: Layout, held_on_output: bool = False) -> dict[str, tuple[int, int]]:
    """Columns of bodies' states: body, and component of x y angle vx vy rate. Pins held by the output turn as it does."""
    wheels = range(layout.bodies)[layout.wheel_bodies]
    names = {"output_rate_rad_s": (1, 5)}
    components = ["x_m", "y_m", "angle_rad", "velocity_x_m_s", "velocity_y_m_s", "rate_rad_s"]
    for component, name in enumerate(components):
        names |= {f"wheel_{name}_{i}": (body, component) for i, body in enumerate(wheels)}
    for kind, bodies in [("external", layout.external_bodies), ("internal", layout.internal_bodies)]:
        sleeves = enumerate(range(layout.bodies)[bodies])
        held = held_on_output and bodies == layout.output_bodies
        names |= {f"{kind}_sleeve_rate_rad_s_{i}": (OUTPUT if held else body, 5) for i, body in sleeves}
    return names


class Recorder:
    """Fills the columns sample by sample."""

    def __init__(self, scene: Scene, kinematics: Kinematics) -> None:
        self.kinematics = kinematics
        self.times_s = scene.solver.sample_times_s()
        self.names = column_names(scene)
        self.table = np.zeros((self.times_s.size, len(self.names)))
        known = state_columns(kinematics.layout, not scene.gear.sleeves_turn[not scene.gear.ring_turns])
        asked = [name for name in known if any(fnmatchcase(name, pattern) for pattern in scene.channels)]
        self.places = {name: known[name] for name in asked}
        self.states = np.zeros((self.times_s.size, len(asked)))
        self.recorded = False
        self.count = 0

    def record(self, states: Floats, loads: Floats, input_torque_n_m: float) -> None:
        """Takes one sample from the bodies' states and contact loads; samples come in order."""
        self.recorded = True
        if self.places:
            self.states[self.count] = [states[place] for place in self.places.values()]
        pins = loads[self.kinematics.layout.external_bodies.start :]
        self.record_forces(
            input_torque_n_m,
            self.kinematics.output_torque(states, loads),
            float(states[1, 2]),
            np.hypot(pins[:, 0], pins[:, 1]),
        )

    def record_forces(
        self,
        input_torque_n_m: float,
        output_torque_n_m: float,
        output_angle_rad: float,
        forces_n: Floats,
    ) -> None:
        """Takes one sample of the contract's quantities; `forces_n` are those of the ring pins, then of the output pins."""
        row = self.table[self.count]
        row[:4] = self.times_s[self.count], input_torque_n_m, output_torque_n_m, output_angle_rad
        row[4:] = forces_n
        self.count += 1

    def columns(self) -> dict[str, Floats]:
        """All samples taken so far."""
        columns = {name: self.table[: self.count, i].copy() for i, name in enumerate(self.names)}
        if self.recorded:
            columns |= {name: self.states[: self.count, i].copy() for i, name in enumerate(self.places)}
        return columns
