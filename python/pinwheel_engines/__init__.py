"""Reference engines for Pinwheel and a second, independent implementation of its contact law.

Two kinds of comparison, never mixed:
- *shared-law*: the engine supplies bodies, joints and time integration; the contact forces come from one law, evaluated
  inside the engine's step.
- *own-contact*: the engine detects and resolves contact itself.

`run` runs a scene in a named engine; `evaluate` is the contact law in numpy. Both engines are imported only when used.
"""

from pinwheel_engines.border import LawPointer
from pinwheel_engines.engines import ENGINES, check, run
from pinwheel_engines.errors import (
    Cancelled,
    Diverged,
    EngineFailed,
    FrozenForces,
    PinwheelError,
    SceneError,
    Unsupported,
)
from pinwheel_engines.law import ContactLaw, evaluate
from pinwheel_engines.result import Result, RunStats
from pinwheel_engines.scene import Scene

__all__ = [
    "ENGINES",
    "Cancelled",
    "ContactLaw",
    "Diverged",
    "EngineFailed",
    "FrozenForces",
    "LawPointer",
    "PinwheelError",
    "Result",
    "RunStats",
    "Scene",
    "SceneError",
    "Unsupported",
    "check",
    "evaluate",
    "run",
]
