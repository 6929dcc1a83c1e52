"""Available engines, and engines from solvers of your own."""

from __future__ import annotations

import hashlib
import inspect
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from pinwheel import _core
from pinwheel.errors import Cancelled, Diverged, InputError
from pinwheel_engines.layout import INPUT, OUTPUT, Kinematics
from pinwheel_engines.result import Recorder, Result, RunStats
from pinwheel_engines.scene import Scene as Tables
from pinwheel_engines.stepping import legs, steps_between

Floats = npt.NDArray[np.float64]
Track = Literal["shared-law", "own-contact"]


class Job:
    """Data and functions of one run for a solver of yours.

    Bodies stand in one order everywhere: input shaft, output shaft, discs, ring pins, output pins. Every
    body turns about its own centre, which its carrier holds, so one absolute angle a body says where all of them are.
    SI, ground frame, angles counter-clockwise.

    Attributes:
        scene: The scene; tables and keys are attributes: `job.scene.gear.eccentricity_m`
        kinematics: Positions from angles and torques from forces; see `pinwheel_engines.layout`
        states: Start, (bodies, 6): x, y, angle, vx, vy, rate
        angles: Start, absolute angles, rad, (bodies,)
        rates: Start, rad/s, (bodies,)
        moments: Mass matrix in the absolute angles, which is diagonal, kg m^2, (bodies,)
        step_s: Step that the scene asks for, s
        stats: Cost and settings; yours to complete
        times_s: Samples are due at these times, s, the start among them

    """

    INPUT, OUTPUT = INPUT, OUTPUT

    def __init__(self, engine: str, scene_toml: str, options: Mapping[str, Any]) -> None:
        self.engine = engine
        self.scene = Tables.from_toml(scene_toml)
        self.kinematics = Kinematics(self.scene.gear)
        self.states: Floats = np.array(options["initial_states"], dtype=np.float64)
        self.angles: Floats = self.states[:, 2].copy()
        self.rates: Floats = self.states[:, 5].copy()
        self.moments: Floats = self.kinematics.lumped_moments(self.scene)
        self.step_s: float = self.scene.solver.step_s
        self.stats = RunStats(
            bodies=self.kinematics.layout.bodies, step_s=self.step_s, degrees_of_freedom=self.scene.gear.wheels + 1
        )
        self._loads = options["loads"]
        self._stop = options["on_progress"]
        self._recorder = Recorder(self.scene, self.kinematics)
        self.times_s: Floats = self._recorder.times_s
        self._breaks = self.scene.drive.load_breaks_s
        self._piece = self.scene.drive.load_piece(0.0)
        self._out: Floats = np.zeros((self.kinematics.layout.bodies, 3))

    def loads(self, states: Floats) -> Floats:
        """Our contact law: loads (bodies, 3), fx, fy in N and the moment in N m, at `states` (bodies, 6)."""
        self.stats.rhs_calls += 1
        return self._evaluate(states)

    def _evaluate(self, states: Floats) -> Floats:
        self._loads(np.ascontiguousarray(states, dtype=np.float64), self._out)
        return self._out.copy()

    def torques(self, time_s: float, angles: Floats, rates: Floats) -> Floats:
        """Contact and load as torques on the absolute angles, N m, (bodies,).

        The driver's is not among them: it holds the input's rate, and is what stands at `Job.INPUT` with the sign changed.
        """
        torques = self.kinematics.torques(angles, self.loads(self.kinematics.states(angles, rates)))
        torques[OUTPUT] += self._load_n_m(time_s)
        return torques

    def _load_n_m(self, time_s: float) -> float:
        return float(self._piece.load_n_m(time_s))

    def intervals(self) -> Iterator[list[tuple[float, float]]]:
        """Gives, from sample to sample, steps (start, length), s, that end on the sample and on every jump of the load."""
        for before, instant in zip(self.times_s[:-1], self.times_s[1:], strict=True):
            steps: list[tuple[float, float]] = []
            for start, end in legs(float(before), float(instant), self._breaks, self.step_s):
                count, length = steps_between(start, end, self.step_s)
                steps += [(start + k * length, length) for k in range(count)]
            self.stats.steps += len(steps)
            yield steps

    def at(self, start_s: float, length_s: float) -> None:
        """Begins a step: a load that jumps at either end has its value within the step."""
        self._piece = self.scene.drive.load_piece(start_s + 0.5 * length_s)

    def sample(self, angles: Floats, rates: Floats, driver_torque_n_m: float | None = None) -> None:
        """Takes the next sample, from absolute angles and rates; the driver's torque follows from them unless given.

        Raises `Diverged` where numbers are not finite, and stops the run when the user does.
        """
        time_s = float(self.times_s[self._recorder.count])
        self._piece = self.scene.drive.load_piece(time_s)
        if not (np.isfinite(angles).all() and np.isfinite(rates).all()):
            raise Diverged(self.engine, time_s, "an angle or a rate is not finite")
        states = self.kinematics.states(angles, rates)
        loads = self._evaluate(states)
        if driver_torque_n_m is None:
            driver_torque_n_m = -float(self.kinematics.torques(angles, loads)[INPUT])
        self._recorder.record(states, loads, driver_torque_n_m)
        if self._stop(time_s):
            raise Cancelled

    def sample_forces(
        self,
        driver_torque_n_m: float,
        output_torque_n_m: float,
        output_angle_rad: float,
        external_n: Floats,
        internal_n: Floats,
    ) -> None:
        """Takes the next sample of a solver with contacts of its own: the sizes of all pins' forces, N."""
        time_s = float(self.times_s[self._recorder.count])
        forces = np.concatenate([external_n, internal_n])
        self._recorder.record_forces(driver_torque_n_m, output_torque_n_m, output_angle_rad, forces)
        if self._stop(time_s):
            raise Cancelled

    def _result(self) -> Result:
        return Result(self.engine, self._recorder.columns(), self.stats)


@dataclass(frozen=True)
class Engine:
    """A solver of yours; made by `engine`."""

    function: Callable[[Job], object]
    name: str
    track: Track
    order: float | None
    version: str
    summary: str
    differences: str

    def __call__(self, job: Job) -> object:
        return self.function(job)

    def _drive(self, scene_toml: str, options: Mapping[str, Any]) -> Result:
        job = Job(self.name, scene_toml, options)
        wall, cpu = time.perf_counter(), time.thread_time()
        try:
            self.function(job)
        except Diverged as error:
            partial: Any = job._result()
            error.partial = partial
            raise
        finally:
            job.stats.wall_s, job.stats.cpu_s = time.perf_counter() - wall, time.thread_time() - cpu
        taken, due = job._recorder.count, job.times_s.size
        if taken != due:
            remedy = "call job.sample once at every time of job.times_s"
            raise RuntimeError(f"{self.name} took {taken} of {due} samples; {remedy}")
        return job._result()


EngineLike: TypeAlias = str | Engine


def several(engines: Sequence[EngineLike] | EngineLike) -> list[EngineLike]:
    """Engines as a list; a single engine may be given without one."""
    return [engines] if isinstance(engines, str | Engine) else list(engines)


def number_of(jobs: int | None) -> int:
    """Number of threads for parallel work: `jobs`, or else one for each core that this process may use."""
    if jobs is not None and jobs < 1:
        raise InputError(f"jobs = {jobs}: write a number of threads from 1 on, or leave it out for one a core")
    return jobs or (len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)


@overload
def engine(function: Callable[[Job], object], /) -> Engine: ...
@overload
def engine(
    *,
    track: Track = ...,
    order: float | None = ...,
    name: str | None = ...,
    version: str | None = ...,
    differences: str = ...,
) -> Callable[[Callable[[Job], object]], Engine]: ...
def engine(
    function: Callable[[Job], object] | None = None,
    /,
    *,
    track: Track = "shared-law",
    order: float | None = None,
    name: str | None = None,
    version: str | None = None,
    differences: str = "",
) -> Engine | Callable[[Callable[[Job], object]], Engine]:
    """Makes a function of a `Job` an engine, for `run`, `compare`, `bench` and `sweep`.

    `track`: "shared-law" if contact forces come from `job.loads`, "own-contact" if you compute them.
    `order`: order of convergence in `solver.step_s`, by which a comparison states the numerical uncertainty; None where
    the step is your own.
    `version`: what it computes must not change under one version; by default a hash of the function's source.

    >>> @engine(track="shared-law", order=1)
    ... def euler(job):
    ...     angles, rates = job.angles, job.rates
    ...     job.sample(angles, rates)
    ...     for steps in job.intervals():
    ...         for start, length in steps:
    ...             job.at(start, length)
    ...             accelerations = job.torques(start, angles, rates) / job.moments
    ...             accelerations[job.INPUT] = 0.0
    ...             rates = rates + length * accelerations
    ...             angles = angles + length * rates
    ...         job.sample(angles, rates)
    >>> import pinwheel
    >>> pinwheel.run(pinwheel.Scene("paper", duration_s=2e-4), euler)["time_s"].size
    3
    """

    def made(function: Callable[[Job], object]) -> Engine:
        title = name or function.__name__.replace("_", "-")
        if any(known.name == title for known in engines()) or title == "native":
            raise InputError(f"there is an engine `{title}` already; give yours another name")
        if track not in ("shared-law", "own-contact"):
            raise InputError(f'track = {track!r}: write "shared-law" or "own-contact"')
        summary = (inspect.getdoc(function) or "a solver in Python").splitlines()[0]
        return Engine(function, title, track, order, version or _version(function), summary, differences or summary)

    return made if function is None else made(function)


def _version(function: Callable[..., object]) -> str:
    try:
        text = inspect.getsource(function).encode()
    except (OSError, TypeError):
        code = getattr(function, "__code__", None)
        text = code.co_code + repr(code.co_consts).encode() if code is not None else repr(function).encode()
    return hashlib.sha256(text).hexdigest()[:12]


@dataclass(frozen=True)
class EngineInfo:
    """An engine of this Python."""

    name: str
    track: str
    version: str
    summary: str
    differences: str
    needs: str | None = None


def engines() -> list[EngineInfo]:
    """The engines of this Python; exudyn and MuJoCo are among them where their packages are installed.

    >>> [e.name for e in engines()][:3]
    ['native-reduced', 'native-lagrange', 'native-resolved']
    """
    return [EngineInfo(**engine) for engine in json.loads(_core.engines())]
