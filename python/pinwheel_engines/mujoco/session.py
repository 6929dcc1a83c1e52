"""MuJoCo's process-wide state, kept to the duration of a run, and the guard against its silent reset.

MuJoCo's callbacks and its log are global. By default it writes MUJOCO_LOG.TXT into the working directory and, when a
number runs away, puts the model back to time 0 and goes on. Here the log is off, callbacks are put back afterwards, runs
take turns, and warnings or a clock that is not where it should be raise `Diverged`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import mujoco

from pinwheel_engines.border import CALLBACK_TYPE
from pinwheel_engines.guards import Guard

_TURN = threading.RLock()

VERSION = str(mujoco.__version__)


@contextmanager
def quiet_session() -> Iterator[None]:
    """Runs the `with` block exclusively, with MuJoCo's log off, and restores its callbacks at the end."""
    with _TURN:
        config = mujoco.MjLogConfig.get()
        before = (bool(config.logto_console), bool(config.logto_file))
        passive, control = mujoco.get_mjcb_passive(), mujoco.get_mjcb_control()
        config.logto_console, config.logto_file = False, False
        mujoco.MjLogConfig.set(config)
        try:
            yield
        finally:
            mujoco.set_mjcb_passive(passive)
            mujoco.set_mjcb_control(control)
            config.logto_console, config.logto_file = before
            mujoco.MjLogConfig.set(config)


class Callback:
    """A Python function as MuJoCo callback whose exception is kept, not thrown through MuJoCo's C code."""

    def __init__(self, function: Callable[[], None]) -> None:
        self.function = function
        self.error: BaseException | None = None
        # The address must stay alive as long as MuJoCo may call it.
        self.pointer = CALLBACK_TYPE(self._call)

    def _call(self, _model: Any, _data: Any) -> None:
        if self.error is None:
            try:
                self.function()
            except BaseException as error:
                self.error = error

    def raise_kept(self) -> None:
        """Raises what the function raised since the last call."""
        if self.error is not None:
            error, self.error = self.error, None
            raise error


def check_data(guard: Guard, data: mujoco.MjData, expected_time_s: float) -> None:
    """Raises Diverged when MuJoCo warned of bad numbers or its clock shows that it reset itself."""
    for kind in (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC):
        warning = data.warning[int(kind)]
        if warning.number > 0:
            name = kind.name.removeprefix("mjWARN_BAD").lower()
            raise guard.diverged(expected_time_s, f"MuJoCo warns of a bad {name}[{warning.lastinfo}]")
    # mjWARN_INERTIA, CONTACTFULL, CNSTRFULL: the step continued with an incomplete model.
    for kind in (mujoco.mjtWarning.mjWARN_INERTIA, mujoco.mjtWarning.mjWARN_CONTACTFULL, mujoco.mjtWarning.mjWARN_CNSTRFULL):
        if data.warning[int(kind)].number > 0:
            raise guard.diverged(expected_time_s, f"MuJoCo warns: {kind.name.removeprefix('mjWARN_').lower()}")
    if abs(data.time - expected_time_s) > 1e-9 * expected_time_s:
        raise guard.diverged(
            expected_time_s, f"MuJoCo's clock stands at {data.time:.6g} s instead: it reset its state without a word"
        )
