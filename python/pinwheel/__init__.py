"""Dynamics of cycloidal gearboxes, computed by several engines and compared.

A cycloidal gearbox turns an eccentric input into a slow output: discs with lobes (*discs*) roll inside a ring of rollers
(*ring pins*), and rollers in the discs' holes (*output pins*) carry the load to the output. A `Scene` says which
gear, load, contact law and solver; an *engine* turns it into time series of forces, torques and angles. All values are SI;
names of keys and columns end in their unit.

>>> import pinwheel
>>> s = pinwheel.Scene("paper", backlash_m=6e-4, duration_s=0.02)
>>> r = s.run("native-reduced")
>>> r["external_sleeve_force_n"].shape
(201, 16)
>>> c = pinwheel.compare(s.with_(backlash_m=0.0, step_s=2e-6), ["native-reduced", "native-lagrange"])
>>> c.passed
True
"""

from importlib import import_module
from typing import TYPE_CHECKING

from pinwheel._core import __version__
from pinwheel._scene import Scene
from pinwheel.errors import (
    Cancelled,
    ClusterError,
    Diverged,
    EngineFailed,
    InputError,
    Missing,
    NoEngine,
    PinwheelError,
    SceneError,
    Unsupported,
)

if TYPE_CHECKING:
    from pinwheel._bench import Bench, bench
    from pinwheel._columns import Columns
    from pinwheel._compare import Comparison, Verdict, compare
    from pinwheel._design import Design, Figure, Limit, design, fmu, gear, statics
    from pinwheel._engine import Engine, EngineInfo, Job, engine, engines
    from pinwheel._explain import Explanation, explain
    from pinwheel._explore import Explorer, explore
    from pinwheel._law import Law, LawInfo, laws
    from pinwheel._run import Run, run
    from pinwheel._sweep import Sweep, sweep
else:
    # numpy takes a tenth of a second to import: what needs it comes when it is asked for.
    _LATER = {
        "_bench": ("Bench", "bench"),
        "_columns": ("Columns",),
        "_compare": ("Comparison", "Verdict", "compare"),
        "_design": ("Design", "Figure", "Limit", "design", "fmu", "gear", "statics"),
        "_engine": ("Engine", "EngineInfo", "Job", "engine", "engines"),
        "_explain": ("Explanation", "explain"),
        "_explore": ("Explorer", "explore"),
        "_law": ("Law", "LawInfo", "laws"),
        "_run": ("Run", "run"),
        "_sweep": ("Sweep", "sweep"),
    }

    def __getattr__(name):
        for module, names in _LATER.items():
            if name in names:
                globals()[name] = getattr(import_module(f"pinwheel.{module}"), name)
                return globals()[name]
        raise AttributeError(f"module 'pinwheel' has no attribute {name!r}")

    def __dir__():
        return [*globals(), *__all__]


__all__ = [
    "Bench",
    "Cancelled",
    "ClusterError",
    "Columns",
    "Comparison",
    "Design",
    "Diverged",
    "Engine",
    "EngineFailed",
    "EngineInfo",
    "Explanation",
    "Explorer",
    "Figure",
    "InputError",
    "Job",
    "Law",
    "LawInfo",
    "Limit",
    "Missing",
    "NoEngine",
    "PinwheelError",
    "Run",
    "Scene",
    "SceneError",
    "Sweep",
    "Unsupported",
    "Verdict",
    "__version__",
    "bench",
    "compare",
    "design",
    "engine",
    "engines",
    "explain",
    "explore",
    "figures",
    "fmu",
    "gear",
    "keys",
    "laws",
    "presets",
    "run",
    "statics",
    "sweep",
]


def presets() -> list[str]:
    """Names of the scenes that come with the package.

    >>> presets()[0]
    'paper'
    """
    from pinwheel import _core

    return _core.presets()


def keys() -> dict[str, str]:
    """Every key of a scene, and what it means.

    >>> keys()["gear.backlash_m"]
    'd: ring pins sit at R + d'
    """
    from pinwheel import _core

    known = _core.keys()
    return {name: about for name, about, _ in known}


def figures() -> dict[str, str]:
    """Every figure of a gear by its key, and what it is.

    >>> figures()["lost_motion_arcmin"]
    'lost motion, arcmin: largest over the mesh, between +3 and -3 % of the rated torque'
    """
    from pinwheel import _core

    return {key: f"{what}, {unit or '1'}: {how}".removesuffix(": ") for key, what, unit, how in _core.figures()}
