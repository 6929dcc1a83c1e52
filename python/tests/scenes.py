"""Scenes and states shared by the tests."""

from __future__ import annotations

import ctypes
import functools
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pinwheel_engines.border import LawPointer
from pinwheel_engines.law import ContactLaw
from pinwheel_engines.layout import Kinematics
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]

PAPER_FILE = Path(__file__).parents[2] / "reference/scenes/paper.toml"
PAPER = Scene.load(PAPER_FILE)

FRICTION = "[contact]\nfriction_coefficient = 0.1\n"
BACKLASH = "[gear]\nbacklash_m = 0.0006\n"
POINTS = '[contact]\ndetection = "points"\nwheel_points = 600\nhole_points = 20\nfriction_coefficient = 0.1\n'
ELEVEN = "[gear]\nexternal_sleeves = 11\ninternal_sleeves = 6\nwheels = 3\n"
ONE_WHEEL = "[gear]\nexternal_sleeves = 30\nwheels = 1\nshortening = 0.5\neccentricity_m = 0.0012\nhole_radius_m = 0.0075\n"

MODIFIED = """
[gear.modification]
equidistant_m = 2e-5
radial_m = -3e-5
rotational_rad = 4e-4
"""
ERRORS = f"""
[gear]
hole_radius_m = 0.00882
backlash_m = 2e-5
[gear.errors]
external_sleeve_radial_m = {[5e-6 * math.sin(7 * j) for j in range(16)]}
external_sleeve_tangential_m = {[5e-6 * math.cos(5 * j) for j in range(16)]}
external_sleeve_radius_m = {[3e-6 * math.sin(3 * j) for j in range(16)]}
internal_sleeve_radial_m = {[5e-6 * math.cos(11 * k) for k in range(8)]}
internal_sleeve_tangential_m = {[5e-6 * math.sin(13 * k) for k in range(8)]}
internal_sleeve_radius_m = {[3e-6 * math.cos(3 * k) for k in range(8)]}
hole_radial_m = {[5e-6 * math.sin(17 * k) for k in range(16)]}
hole_tangential_m = {[5e-6 * math.cos(19 * k) for k in range(16)]}
hole_radius_m = {[3e-6 * math.sin(23 * k) for k in range(16)]}
eccentricity_m = [4e-6, -3e-6]
phase_rad = [3e-4, -5e-4]
"""
RING = "[gear]\nring_turns = true\n"
LINE = '[contact]\nlaw = "line-hertz"\npin_young_pa = 1.1e11\npin_poisson = 0.25\nfriction_coefficient = 0.1\n'

ALL = {
    "paper": "",
    "friction": FRICTION,
    "backlash": BACKLASH,
    "points": POINTS,
    "eleven": ELEVEN,
    "one-wheel": ONE_WHEEL,
    "modified": MODIFIED,
    "errors": ERRORS,
    "line": LINE,
    "ring": RING,
}


def scene(text: str = "", duration_s: float = 2e-3, **solver: float) -> Scene:
    """The paper's gear in a short run, with the keys of `text` in place of its own."""
    scene = PAPER
    for table, keys in tomllib.loads(text).items():
        scene = scene.with_keys(table, **keys)
    return scene.with_keys("solver", duration_s=duration_s, **solver)


def paper_text(**keys: object) -> str:
    """The text of the paper's scene with other values of keys; each is on one line of its own."""
    text = PAPER_FILE.read_text(encoding="utf-8")
    for key, value in keys.items():
        text, count = re.subn(rf"^{key} = .*", f"{key} = {value}", text, flags=re.MULTILINE)
        assert count == 1, key
    return text


def random_states(scene: Scene, count: int, seed: int = 1, spread_rad: float = 2e-4) -> Floats:
    """States near the mesh: random input angles, angles and rates off the ideal ones, pins that turn."""
    rng = np.random.default_rng(seed)
    kinematics = Kinematics(scene.gear)
    layout = kinematics.layout
    states = np.empty((count, layout.bodies, 6))
    for i in range(count):
        angles, rates = kinematics.ideal(scene, rng.uniform(0.0, 0.6))
        twist = rng.uniform(-1.0, 1.0) * scene.gear.backlash_m * 15.0
        angles[1:] += twist
        angles[1 : layout.wheel_bodies.stop] += rng.normal(size=1 + layout.wheels) * spread_rad
        rates[1:] += rng.normal(size=layout.bodies - 1) * 0.5
        states[i] = kinematics.states(angles, rates)
    return states


class PlainLaw:
    """The numpy law behind C function pointers, as a compiled law would come; without a compiler."""

    def __init__(self, scene: Scene, direct: bool = False, counting: bool = True) -> None:
        self.scene, self.law, self.kinematics = scene, ContactLaw(scene), Kinematics(scene.gear)
        self.counting = counting
        self.layout: dict[str, Any] | None = None
        self.detached = 0
        law_type = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p)
        self.function = law_type(self._law)
        passive_type = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
        self.passive = passive_type(self._passive)
        self.pointer = LawPointer(
            ctypes.cast(self.function, ctypes.c_void_p).value or 0,
            0,
            self._attach if direct else None,
            self._detach if direct else None,
        )

    def _law(self, _context: Any, _time: float, states: int, loads: int) -> None:
        bodies = self.kinematics.layout.bodies
        array(loads, 3 * bodies)[:] = self.law.loads(array(states, 6 * bodies).reshape(1, bodies, 6)).ravel()

    def _attach(self, layout: dict[str, Any]) -> int:
        self.layout = layout
        self.last = np.zeros(2 * layout["coordinates"])
        return ctypes.cast(self.passive, ctypes.c_void_p).value or 0

    def _detach(self) -> None:
        self.detached += 1
        self.layout = None

    def _passive(self, _model: int, data: int) -> None:
        layout = self.layout
        assert layout is not None
        assert data == layout["data"]
        count, order = layout["coordinates"], np.array(layout["coordinate"])
        q, v = array(layout["qpos"], count), array(layout["qvel"], count)
        if self.counting:
            counters = np.ctypeslib.as_array(ctypes.cast(layout["counters"], ctypes.POINTER(ctypes.c_int64)), (2,))
            counters[0] += 1
            now = np.concatenate([q, v])
            counters[1] += int(not np.array_equal(now, self.last))
            self.last = now
        carrier = np.array(layout["carrier"])
        angles, rates = q[order], v[order]
        carried = carrier >= 0
        angles[carried] += angles[carrier[carried]]
        rates[carried] += rates[carrier[carried]]
        at = np.array(layout["offset_x_m"]) + 1j * np.array(layout["offset_y_m"])
        turn = np.where(carried, np.exp(1j * angles[carrier]), 1.0)
        swing = np.where(carried, 1j * rates[carrier], 0.0) * at * turn
        states = np.column_stack([(at * turn).real, (at * turn).imag, angles, swing.real, swing.imag, rates])
        loads = self.law.loads(states[None])[0]
        torques = loads[:, 2].copy()
        for body in np.nonzero(carried)[0]:
            arm = (at * turn)[body]
            torques[carrier[body]] += loads[body, 2] + arm.real * loads[body, 1] - arm.imag * loads[body, 0]
        array(layout["qfrc_passive"], count)[order] += torques


def array(address: int, count: int) -> Floats:
    """Doubles at an address."""
    return np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(ctypes.c_double)), (count,))


@functools.cache
def wanted(text: str, duration_s: float, step_s: float) -> dict[str, Floats]:
    """The courses of `scene(text, duration_s)` by `runge_kutta`, once for all engines."""
    return runge_kutta(scene(text, duration_s), step_s)


def runge_kutta(scene: Scene, step_s: float) -> dict[str, Floats]:
    """Courses by classical Runge-Kutta on absolute angles with lumped moments: no engine, no joint, no multiplier."""
    from pinwheel_engines.result import Recorder
    from pinwheel_engines.start import initial_angles
    from pinwheel_engines.stepping import legs, steps_between

    kinematics, law = Kinematics(scene.gear), ContactLaw(scene)
    moments = kinematics.lumped_moments(scene)
    angles, rates = initial_angles(scene)
    recorder = Recorder(scene, kinematics)
    load = scene.drive.load_piece(0.0)

    def evaluate(a: Floats, r: Floats) -> tuple[Floats, Floats, Floats]:
        states = kinematics.states(a, r)
        loads = law.loads(states[None])[0]
        return states, loads, kinematics.torques(a, loads)

    def acceleration(time_s: float, a: Floats, r: Floats) -> Floats:
        torques = evaluate(a, r)[2]
        torques[1] += load.load_n_m(time_s)
        result = torques / moments
        result[0] = 0.0
        return result

    times = recorder.times_s
    for k, instant in enumerate(times):
        if k > 0:
            for start, end in legs(float(times[k - 1]), float(instant), scene.drive.load_breaks_s, step_s):
                load = scene.drive.load_piece(0.5 * (start + end))
                count, h = steps_between(start, end, step_s)
                for i in range(count):
                    t = start + i * h
                    k1 = acceleration(t, angles, rates)
                    r2 = rates + 0.5 * h * k1
                    k2 = acceleration(t + 0.5 * h, angles + 0.5 * h * rates, r2)
                    r3 = rates + 0.5 * h * k2
                    k3 = acceleration(t + 0.5 * h, angles + 0.5 * h * r2, r3)
                    r4 = rates + h * k3
                    k4 = acceleration(t + h, angles + h * r3, r4)
                    angles = angles + h / 6.0 * (rates + 2.0 * r2 + 2.0 * r3 + r4)
                    rates = rates + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        states, loads, torques = evaluate(angles, rates)
        recorder.record(states, loads, -float(torques[0]))
    return recorder.columns()


def relative_rms(computed: dict[str, Floats], wanted: dict[str, Floats], start: str) -> float:
    """RMS of the difference over RMS of the reference, all columns that start with a word together."""
    names = [name for name in wanted if name.startswith(start)]
    a = np.array([computed[name] for name in names])
    b = np.array([wanted[name] for name in names])
    return float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)))


GROUPS = ("external", "internal", "input_torque", "output_torque", "output_angle")


def worst_rms(computed: dict[str, Floats], wanted: dict[str, Floats]) -> float:
    """The largest relative RMS of the contract's groups of columns."""
    return max(relative_rms(computed, wanted, group) for group in GROUPS)
