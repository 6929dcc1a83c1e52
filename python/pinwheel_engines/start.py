"""Initial state of a run: the ideal mesh, or the same mesh under its load.

`kinematic`: angles and rates of the ideal mesh. `equilibrium`: the output and the discs are turned until the contact
forces, without friction and damping, carry the load; the rates are the ideal ones. Both come as absolute angles and
rates of all bodies (see `layout`).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import SceneError
from pinwheel_engines.law import ContactLaw
from pinwheel_engines.layout import OUTPUT, Kinematics
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]

# Parts of a bracket that are tried at once.
SECTIONS = 16


def initial_angles(scene: Scene, given: Floats | None = None) -> tuple[Floats, Floats]:
    """Absolute angles and rates at time 0. `given` (bodies, 6) overrules the scene; its positions follow its angles."""
    kinematics = Kinematics(scene.gear)
    if given is not None:
        states = np.asarray(given, dtype=np.float64)
        if states.size != 6 * kinematics.layout.bodies or not np.all(np.isfinite(states)):
            raise SceneError(
                f"the initial states must be {kinematics.layout.bodies} bodies of 6 finite numbers, "
                f"not an array of shape {states.shape}"
            )
        states = states.reshape(-1, 6)
        return states[:, 2].copy(), states[:, 5].copy()
    angles, rates = kinematics.ideal(scene)
    if scene.drive.start == "equilibrium":
        _load(scene, kinematics, angles, rates)
    return angles, rates


def initial_states(scene: Scene, given: Floats | None = None) -> Floats:
    """States (bodies, 6) at the start. Discs that float stand where the given ones have them, else on their eccentrics."""
    kinematics = Kinematics(scene.gear)
    states = kinematics.states(*initial_angles(scene, given))
    if scene.floats and given is not None:
        wheels = kinematics.layout.wheel_bodies
        states[wheels] = np.asarray(given, dtype=np.float64).reshape(-1, 6)[wheels]
    return states


def _load(scene: Scene, kinematics: Kinematics, angles: Floats, rates: Floats) -> None:
    """Turns the output and the discs until the load at time 0 is carried."""
    load = scene.drive.load_n_m(0.0)
    if load == 0.0:
        return
    law = ContactLaw(scene.with_keys("contact", friction_coefficient=0.0, damping_n_s_m=0.0))
    layout = kinematics.layout
    wheels = np.arange(layout.wheel_bodies.start, layout.wheel_bodies.stop)
    ideal = angles.copy()
    sense = 1.0 if load > 0.0 else -1.0

    def torques(turn: float, wheel_turns: Floats) -> Floats:
        """Restoring torques (points, bodies) at disc turns (points, discs): all together, as the law costs hardly more."""
        points = np.empty((len(wheel_turns), angles.size))
        for point, turns in zip(points, wheel_turns, strict=True):
            angles[OUTPUT] = ideal[OUTPUT] + sense * turn
            angles[layout.output_bodies] = ideal[layout.output_bodies] + sense * turn
            angles[wheels] = ideal[wheels] + sense * turns
            point[:] = angles
        loads = law.loads(np.array([kinematics.states(point, rates) for point in points]))
        torques = [kinematics.torques(point, one) for point, one in zip(points, loads, strict=True)]
        return sense * np.array(torques)

    def settle(turn: float) -> Floats:
        """Turns of the discs in balance with the output held; discs do not act on each other."""
        low = np.full(wheels.size, -0.5 * np.pi / scene.gear.lobes)
        width = np.pi / scene.gear.lobes
        shares = np.arange(1, SECTIONS)[:, None] / SECTIONS
        # Equivalent to 60 halvings.
        for _ in range(round(60 / math.log2(SECTIONS))):
            pushed_on = torques(turn, low + width * shares)[:, wheels] > 0.0
            width /= SECTIONS
            low += width * np.sum(np.logical_and.accumulate(pushed_on), axis=0)
        return np.asarray(low + 0.5 * width)

    def excess(turn: float) -> float:
        """Restoring torque of the contacts on the output less the load."""
        return float(-torques(turn, settle(turn)[None])[0, OUTPUT] - abs(load))

    turn = _rising_root(excess, 0.25 * np.pi / scene.gear.lobes)
    if turn is None:
        raise SceneError(
            "the gear cannot carry its load at rest, so `drive.start` = 'equilibrium' has no answer; use 'kinematic'"
        )
    torques(turn, settle(turn)[None])


def _rising_root(f: Callable[[float], float], end: float) -> float | None:
    """Root of a function that is negative at 0 and rises, by the Illinois method; None when f(end) is still negative."""
    low, high = 0.0, end
    f_low, f_high = f(low), f(high)
    if f_high < 0.0:
        return None
    for _ in range(100):
        x = high - f_high * (high - low) / (f_high - f_low)
        fx = f(x)
        if fx == 0.0 or abs(high - low) < 1e-14:
            return x
        if fx * f_high < 0.0:
            low, f_low = high, f_high
        else:
            f_low *= 0.5
        high, f_high = x, fx
    return high
