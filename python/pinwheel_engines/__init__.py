"""Reference engines for Pinwheel and a second, independent implementation of its contact law.

Two kinds of comparison, never mixed:
- *shared-law*: the engine supplies bodies, joints and time integration; the contact forces come from one law, evaluated
  inside the engine's step.
- *own-contact*: the engine detects and resolves contact itself.

`run` runs a scene in a named engine; `evaluate` is the contact law in numpy. Both engines are imported only when used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from pinwheel_engines.errors import (
    Cancelled,
    Diverged,
    EngineFailed,
    FrozenForces,
    PinwheelError,
    SceneError,
    Unsupported,
)

if TYPE_CHECKING:
    from pinwheel_engines.border import LawPointer
    from pinwheel_engines.engines import ENGINES, check, run
    from pinwheel_engines.law import ContactLaw, evaluate
    from pinwheel_engines.result import Result, RunStats
    from pinwheel_engines.scene import Scene
else:
    # numpy takes a tenth of a second to import: what needs it comes when it is asked for.
    _LATER = {
        "border": ("LawPointer",),
        "engines": ("ENGINES", "check", "run"),
        "law": ("ContactLaw", "evaluate"),
        "result": ("Result", "RunStats"),
        "scene": ("Scene",),
    }

    def __getattr__(name):
        for module, names in _LATER.items():
            if name in names:
                globals()[name] = getattr(import_module(f"pinwheel_engines.{module}"), name)
                return globals()[name]
        raise AttributeError(f"module 'pinwheel_engines' has no attribute {name!r}")


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
