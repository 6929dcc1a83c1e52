"""The border over which the contact law reaches an engine.

Default path of the Pinwheel program: the law is compiled. It hands over the address of a C function

    void law(void *context, double time_s, const double *states, double *loads)

with `states` as (bodies, 6) and `loads` as (bodies, 3) row-major arrays of doubles in the order of `layout`; `loads` is
overwritten. The function must not keep the addresses, must not call Python and must not raise. Without it the numpy law
of this package serves: slower by a factor of about thirty, no compiler needed.

Who owns what: the arrays belong to this module and live as long as the `StageLaw`; `context` belongs to the caller and
must outlive the run.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import FrozenForces, Unsupported
from pinwheel_engines.law import ContactLaw
from pinwheel_engines.layout import Kinematics, Layout
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.intp]

# MuJoCo's callbacks, and the compiled one.
CALLBACK_TYPE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)
_LAW_TYPE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p)


@dataclass(frozen=True)
class LawPointer:
    """A compiled contact law.

    `function`: address of the C function above; `context`: its first argument.
    `attach`: optional; gets the layout of `joint_layout` and returns the address of a C function
    `void(const void *, void *data)`, MuJoCo's `mjcb_passive`, which adds the contact torques itself, or None to decline.
    `detach` is called when the run is over, whatever happened; after it the layout's addresses are stale.
    """

    function: int
    context: int
    attach: Callable[[dict[str, Any]], int | None] | None = None
    detach: Callable[[], None] | None = None


def joint_layout(
    kinematics: Kinematics, coordinate: Integers, data: int, angles: Floats, rates: Floats, torques: Floats
) -> dict[str, Any]:
    """Addresses of an engine's arrays for a compiled callback; all addresses stay valid until the run ends.

    Addresses (integers): `qpos`, `qvel`, `qfrc_passive` (doubles, `coordinates` of each), `counters` (two 64-bit integers,
    to be incremented by the callback: calls, and calls whose qpos or qvel differ from the call before), `data` (second
    argument of the callback, which tells runs apart: it is process-wide and must leave any other one alone).
    Lists, one entry a body: `coordinate` (its hinge's index in the three arrays), `carrier` (body it sits on, -1 for the
    ground; its absolute angle is its hinge's plus its carrier's), `offset_x_m`, `offset_y_m` (its centre on its carrier).
    The callback adds to `qfrc_passive`, per hinge, the torques of `Kinematics.relative_torques`.
    """
    counters = np.zeros(2, dtype=np.int64)
    return {
        "bodies": kinematics.layout.bodies,
        "coordinates": angles.size,
        "qpos": int(angles.ctypes.data),
        "qvel": int(rates.ctypes.data),
        "qfrc_passive": int(torques.ctypes.data),
        "data": data,
        "counters": int(counters.ctypes.data),
        "counters_array": counters,
        "coordinate": coordinate.tolist(),
        "carrier": kinematics.carriers.tolist(),
        "offset_x_m": kinematics.offsets.real.tolist(),
        "offset_y_m": kinematics.offsets.imag.tolist(),
    }


def attached(scene: Scene, law: LawPointer | None, layout: dict[str, Any]) -> int | None:
    """Address of the compiled callback of a layout; None without one, and for slides: it knows hinges alone."""
    return None if law is None or law.attach is None or scene.floats else law.attach(layout)


def detach(law: LawPointer | None) -> None:
    """Makes the layout's addresses stale."""
    if law is not None and law.detach is not None:
        law.detach()


class StageLaw:
    """The law as one run sees it: fixed arrays, and counts of its calls.

    Fill `states` (bodies, 6), call `evaluate`, read `loads` (bodies, 3).
    """

    def __init__(self, scene: Scene, pointer: LawPointer | None) -> None:
        layout = Layout.of(scene.gear)
        self.states: Floats = np.zeros((layout.bodies, 6))
        self.loads: Floats = np.zeros((layout.bodies, 3))
        self.calls = 0
        self.changes = 0
        self._last = b""
        self.pointer = pointer
        if pointer is None:
            self._law = ContactLaw(scene)
            self.evaluate_at = self._numpy
        else:
            self._function = _LAW_TYPE(pointer.function)
            self._arguments = (pointer.context, self.states.ctypes.data, self.loads.ctypes.data)
            self.evaluate_at = self._compiled

    @property
    def name(self) -> str:
        """Name of the implementation, in words."""
        return "numpy law" if self.pointer is None else "compiled law"

    def evaluate(self, time_s: float) -> Floats:
        """Evaluates the law at a stage of the integration, and counts the call."""
        self.calls += 1
        now = self.states.tobytes()
        if now != self._last:
            self.changes += 1
            self._last = now
        return self.evaluate_at(time_s)

    def _compiled(self, time_s: float) -> Floats:
        context, states, loads = self._arguments
        self._function(context, time_s, states, loads)
        return self.loads

    def _numpy(self, time_s: float) -> Floats:
        del time_s  # the law knows no time
        self.loads[:] = self._law.loads(self.states[None])[0]
        return self.loads


def check_bearings(engine: str, scene: Scene, law: LawPointer | None) -> None:
    """Raises Unsupported where a bearing, pin or seal acts and the law is the numpy one, which has none of them."""
    if scene.compiled_only and law is None:
        raise Unsupported(engine, f"{scene.compiled_only}: the numpy law has contacts alone; run it by the Pinwheel program")


def check_not_frozen(engine: str, steps: int, stages: int, calls: int, changes: int) -> None:
    """Raises FrozenForces unless the forces were asked for in every stage, with states that move from stage to stage.

    Forces that an engine keeps over a step give a smooth, plausible and wrong run. `stages` is the number of evaluations
    one step needs at least. Within a step two stages may share a state only while nothing moves.
    """
    if calls < steps * stages:
        raise FrozenForces(
            f"{engine} asked for the contact forces {calls} times in {steps} steps of {stages} stages; forces would be "
            "frozen over a step: attach the law as a force callback, not as a load"
        )
    # A stage repeats its predecessor's state at most once a step (an engine may re-evaluate at the step's start).
    least = steps * max(1, stages - 1)
    if changes < least:
        raise FrozenForces(
            f"{engine} called the contact law with only {changes} different states in {steps} steps of {stages} stages; "
            "the states handed over do not follow the stages"
        )
