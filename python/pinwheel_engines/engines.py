"""The engines by name, and the one way to run any of them."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from pinwheel_engines.bed import check_own_contact
from pinwheel_engines.border import LawPointer
from pinwheel_engines.errors import EngineFailed, PinwheelError, Unsupported
from pinwheel_engines.result import Result
from pinwheel_engines.scene import Scene


@dataclass(frozen=True)
class EngineInfo:
    """One engine: where its code is, which comparison it belongs to, and how it differs in plain words."""

    module: str
    track: str
    takes_law: bool
    summary: str
    differences: str


ENGINES: dict[str, EngineInfo] = {
    "mujoco-shared-law": EngineInfo(
        "pinwheel_engines.mujoco.shared_law",
        "shared-law",
        True,
        "MuJoCo: hinges as a tree, Runge-Kutta 4, the shared law in every stage",
        "Same contact law. MuJoCo's articulated-body equations in relative joint angles and its own Runge-Kutta 4. The "
        "input speed is held by a rotor inertia of 1e12 kg m^2 instead of a constraint (one part in 1e14).",
    ),
    "mujoco-own-contact": EngineInfo(
        "pinwheel_engines.mujoco.own_contact",
        "own-contact",
        False,
        "MuJoCo: wheel edges as beds of 4000 small spheres, holes as limited tendons, no code of ours in the step",
        "MuJoCo finds the contacts and computes the forces: a bed of linear springs along each wheel's edge, which gives "
        "K delta^1.5 for a locally circular edge and conserves energy where the paper's law does not; tendons with a chord "
        "approximation of K delta^1.5 in the holes. No ramp S, no friction, semi-implicit steps of 1e-4 s: steady courses "
        "are comparable, the start-up transient is not.",
    ),
    "exudyn-shared-law-explicit": EngineInfo(
        "pinwheel_engines.exudyn.explicit",
        "shared-law",
        True,
        "exudyn: one kinematic tree, Runge-Kutta 4, the shared law in every stage",
        "Same contact law. exudyn's kinematic tree in relative joint angles and its own Runge-Kutta 4. The input speed is "
        "held by a rotor inertia of 1e12 kg m^2 instead of a constraint (one part in 1e14).",
    ),
    "exudyn-shared-law-constrained": EngineInfo(
        "pinwheel_engines.exudyn.constrained",
        "shared-law",
        True,
        "exudyn: free bodies, joints and driver as constraints with multipliers, implicit trapezoidal rule",
        "Same contact law. Three coordinates a body and Lagrange multipliers as in the paper, but an implicit second-order "
        "method with Newton iterations; constraints hold at velocity level. Its error falls four times when the step is "
        "halved.",
    ),
    "exudyn-own-contact": EngineInfo(
        "pinwheel_engines.exudyn.own_contact",
        "own-contact",
        False,
        "exudyn: circles on a polygon of 8000 spring segments, spheres in hollow spheres, no code of ours in the step",
        "exudyn finds the contacts and computes the forces: spring segments along each wheel's edge, which conserve energy "
        "where the paper's law does not; hollow spheres with exponent 1.5 in the holes. The external contacts' damping acts "
        "as a rotational damper on the wheels. No ramp S, no friction.",
    ),
}


def check(scene: str | Scene, engine: str) -> None:
    """Raises SceneError or Unsupported when an engine cannot honour a scene; starts no run.

    A shared-law engine can do what its law can; what an own-contact engine can do is `bed.check_own_contact`'s.
    """
    if engine not in ENGINES:
        raise Unsupported(engine, f"there is no such engine; known are {', '.join(ENGINES)}")
    scene = Scene.of(scene)
    if not ENGINES[engine].takes_law:
        check_own_contact(engine, scene)


def run(
    scene: str | Scene,
    engine: str,
    law: LawPointer | None = None,
    on_progress: Callable[[float], bool] | None = None,
    step_s: float | None = None,
    initial_states: npt.ArrayLike | None = None,
) -> Result:
    """Runs a scene, itself or its TOML text, in a named engine.

    `law`: a compiled contact law for shared-law engines; without it the numpy law serves. Own-contact engines ignore it.
    `on_progress`: gets simulated seconds at every sample; True stops the run with Cancelled.
    `step_s`: the engine's step; by default the scene's for shared-law engines and the engine's own choice otherwise.
    `initial_states`: (bodies, 6) in the order of `layout`; by default what `drive.start` says. Only the angles and rates are
    taken, positions follow from them.

    Raises SceneError, Unsupported, Diverged (with the courses until then in `partial`), FrozenForces, Cancelled,
    EngineFailed (any error of the engine itself, with its text).
    """
    if engine not in ENGINES:
        raise Unsupported(engine, f"there is no such engine; known are {', '.join(ENGINES)}")
    info = ENGINES[engine]
    scene = Scene.of(scene)
    try:
        module = importlib.import_module(info.module)
    except ImportError as error:
        raise EngineFailed(engine, f"{error}; install what python/requirements.txt lists") from error
    options: dict[str, Any] = {"on_progress": on_progress, "step_s": step_s}
    if initial_states is not None:
        options["initial"] = np.asarray(initial_states, dtype=np.float64)
    if info.takes_law:
        options["law"] = law
    try:
        result: Result = module.run(scene, **options)
    except (PinwheelError, KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except Exception as error:
        text = " ".join(str(error).split()) or type(error).__name__
        raise EngineFailed(engine, f"{type(error).__name__}: {text[:400]}") from error
    return result
