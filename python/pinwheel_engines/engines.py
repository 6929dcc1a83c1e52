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
    """Module of an engine, and support of the shared law. The program's cards describe the differences between engines."""

    module: str
    takes_law: bool
    summary: str


ENGINES: dict[str, EngineInfo] = {
    "mujoco-shared-law": EngineInfo(
        "pinwheel_engines.mujoco.shared_law",
        True,
        "MuJoCo: hinges as a tree, Runge-Kutta 4, the shared law in every stage",
    ),
    "mujoco-own-contact": EngineInfo(
        "pinwheel_engines.mujoco.own_contact",
        False,
        "MuJoCo: disc edges as beds of small spheres, holes as limited tendons, no code of ours in the step",
    ),
    "exudyn-shared-law-explicit": EngineInfo(
        "pinwheel_engines.exudyn.explicit",
        True,
        "exudyn: one kinematic tree, Runge-Kutta 4, the shared law in every stage",
    ),
    "exudyn-shared-law-constrained": EngineInfo(
        "pinwheel_engines.exudyn.constrained",
        True,
        "exudyn: free bodies, joints and driver as constraints with multipliers, implicit trapezoidal rule",
    ),
    "exudyn-own-contact": EngineInfo(
        "pinwheel_engines.exudyn.own_contact",
        False,
        "exudyn: circles on a polygon of spring segments, spheres in hollow spheres, no code of ours in the step",
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
