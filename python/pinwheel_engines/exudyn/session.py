"""exudyn's process-wide settings, its solver settings, and the sampling of one run.

exudyn by default prints to the console and writes `solution/...` into the working directory; a run that blows up
reports success. Here nothing is printed or written, every sample is checked, and a Python error inside a user function is
kept and raised after the solver has stopped.
"""

from __future__ import annotations

import struct
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import exudyn as exu
import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import Diverged, EngineFailed
from pinwheel_engines.scene import Drive
from pinwheel_engines.stepping import Stretch

Floats = npt.NDArray[np.float64]

_TURN = threading.RLock()

VERSION = str(exu.__version__)


@contextmanager
def quiet_session() -> Iterator[None]:
    """Runs the `with` block exclusively, with exudyn's console output and warnings off, and restores both at the end."""
    with _TURN:
        before = (exu.config.printToConsole, exu.config.suppressWarnings)
        exu.config.printToConsole, exu.config.suppressWarnings = False, True
        try:
            yield
        finally:
            exu.config.printToConsole, exu.config.suppressWarnings = before


def settings_for(stretch: Stretch) -> Any:
    """Solver settings with fixed steps and no files."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    time = settings.timeIntegration
    time.startTime, time.endTime, time.numberOfSteps = stretch.start_s, stretch.end_s, stretch.steps
    time.automaticStepSize = False
    time.adaptiveStep = False
    time.verboseMode = 0
    time.verboseModeFile = 0
    return settings


class Kept:
    """Wraps user functions so that a Python error is kept instead of crossing exudyn's C++ code."""

    def __init__(self) -> None:
        self.error: BaseException | None = None

    def function(self, body: Callable[..., Any], failed: Any) -> Callable[..., Any]:
        """`body` as a user function; after an error it answers `failed` and is called no more."""

        def guarded(*arguments: Any) -> Any:
            if self.error is None:
                try:
                    return body(*arguments)
                except BaseException as error:
                    self.error = error
            return failed

        return guarded

    def raise_kept(self) -> None:
        """Raises what a user function raised."""
        if self.error is not None:
            error, self.error = self.error, None
            raise error


class Coordinates:
    """Copy of the lists of coordinates and rates that exudyn gives a user function; numpy takes three times as long."""

    def __init__(self, count: int) -> None:
        self.values = np.zeros((2, count))
        self._pack = struct.Struct(f"{2 * count}d").pack_into

    def take(self, q: Sequence[float], q_t: Sequence[float]) -> None:
        """Copies coordinates to the first row of `values`, and rates to the second."""
        self._pack(self.values.data, 0, *q, *q_t)


class Load:
    """Load of the current stretch."""

    def __init__(self, drive: Drive) -> None:
        self.drive = drive
        self.piece = drive.load_piece(0.0)

    def begin(self, stretch: Stretch) -> None:
        """Selects the piece of the load in which a stretch lies."""
        self.piece = self.drive.load_piece(0.5 * (stretch.start_s + stretch.end_s))


def solve(
    engine: str,
    system: Any,
    parts: list[Stretch],
    kept: Kept,
    solver: Any,
    sample: Callable[[float], None],
    adjust: Callable[[Any], None] = lambda _settings: None,
    begin: Callable[[Stretch], None] = lambda _stretch: None,
) -> int:
    """Integrates all stretches, calls `sample(time)` after every sample's last step; returns the number of steps.

    `begin` is called before each stretch: the load is then that of the stretch.

    `sample` may raise: the run stops and the error comes out here. exudyn's own errors become EngineFailed, or Diverged
    when its solver gave up a step.
    """
    done = 0
    for number, stretch in enumerate(parts):
        settings = settings_for(stretch)
        adjust(settings)
        begin(stretch)
        counter = {"steps": 0}
        size = (stretch.end_s - stretch.start_s) / stretch.steps

        def after_step(
            _system: Any,
            time_s: float,
            stretch: Stretch = stretch,
            size: float = size,
            counter: dict[str, int] = counter,
            explicit: Any = settings.timeIntegration.explicitIntegration,
        ) -> bool:
            # Some solvers call this once before the first step.
            if time_s - stretch.start_s < 0.5 * size:
                return True
            counter["steps"] += 1
            if stretch.sampled and counter["steps"] % stretch.steps_a_sample == 0:
                sample(time_s)
            # An explicit solver's evaluation after a step serves its accelerations alone, which only samples need.
            explicit.computeEndOfStepAccelerations = (counter["steps"] + 1) % stretch.steps_a_sample == 0
            return True

        system.SetPostStepUserFunction(kept.function(after_step, False))
        if number > 0:
            carry_over(system)
        try:
            system.SolveDynamic(settings, solverType=solver)
        except Exception as error:
            kept.raise_kept()
            time_s = stretch.start_s + (counter["steps"] + 1) * size
            text = " ".join(str(error).split())
            if isinstance(error, exu.SolverError):
                raise Diverged(engine, time_s, f"the solver gave up: {text[:200]}") from error
            raise EngineFailed(engine, text[:400]) from error
        finally:
            system.SetPostStepUserFunction(0)
        kept.raise_kept()
        done += counter["steps"]
        if counter["steps"] != stretch.steps:
            raise EngineFailed(engine, f"the solver made {counter['steps']} steps instead of {stretch.steps}")
    return done


def carry_over(system: Any) -> None:
    """Makes the current state the initial one of the next solver call."""
    data, current, initial = system.systemData, exu.ConfigurationType.Current, exu.ConfigurationType.Initial
    data.SetODE2Coordinates(data.GetODE2Coordinates(current), initial)
    data.SetODE2Coordinates_t(data.GetODE2Coordinates_t(current), initial)
    data.SetDataCoordinates(data.GetDataCoordinates(current), initial)
