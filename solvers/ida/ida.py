"""A gearbox in SUNDIALS IDA: three coordinates a body, every joint and the driver as constraints with multipliers.

    python ida.py JOB LAW

JOB is the folder of one run, LAW the library of Pinwheel's contact law. The equations are those of index 2 in the
stabilised form of Gear, Gupta and Leimkuhler (ACM TOMS 11, 1985): constraints hold at position and at velocity level,
and nothing drifts. With q the coordinates, v the velocities and G the constraints' gradient:

    q' = v - G^T mu,    M v' = f(q, v, t) - G^T lambda,    g(q, t) = 0,    G v + g_t = 0

IDA's variable-order BDF method with Newton's iterations takes them as they are. Its error test leaves the multipliers out,
which are as good as the last iteration left them: 12 % off in the driver torque where forces are within 5e-6. So those
that are written are computed from the accelerations that position and velocity demand.
"""

from __future__ import annotations

import ctypes
import json
import os
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

# Matrices of 282 rows: threads would wait for each other longer than they compute.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# sksundae imports scipy for sparse Jacobians alone, and loading it takes two thirds of the start.
for name in ("scipy", "scipy.sparse", "scipy.optimize", "scipy.optimize._numdiff"):
    sys.modules[name] = ModuleType(name)
vars(sys.modules["scipy"])["sparse"] = sys.modules["scipy.sparse"]
vars(sys.modules["scipy.optimize._numdiff"])["group_columns"] = None

import numpy as np  # noqa: E402
import sksundae as sun  # noqa: E402

FINISHED, FAILED, DIVERGED, USAGE = 0, 1, 3, 1
INPUT, OUTPUT = 0, 1
FREE = -2
NOT_FINITE = -3  # status of the law where states are no numbers
DOUBLES = ctypes.POINTER(ctypes.c_double)


class DivergedError(Exception):
    """The run diverged; the courses until then are written."""


class Law:
    """The contact law behind its C interface."""

    def __init__(self, library: str, job: Path) -> None:
        self._c = c = ctypes.CDLL(library)
        c.pinwheel_law_abi.restype = ctypes.c_uint32
        c.pinwheel_law_close.restype = None
        if c.pinwheel_law_abi() != 2:
            raise RuntimeError("the law's library is of another version than 2")
        c.pinwheel_law_error.restype = ctypes.c_char_p
        c.pinwheel_law_load_torque.restype = ctypes.c_double
        c.pinwheel_law_load_torque.argtypes = [ctypes.c_void_p, ctypes.c_double]
        self._handle = ctypes.c_void_p()
        self._check(c.pinwheel_law_open(str(job).encode(), ctypes.byref(self._handle)))
        self.bodies = c.pinwheel_law_bodies(self._handle)
        # One pair of arrays for all calls.
        self.states, self.loads = np.zeros((self.bodies, 6)), np.zeros((self.bodies, 3))
        self._arguments = (
            self._handle,
            self.states.ctypes.data_as(DOUBLES),
            self.loads.ctypes.data_as(DOUBLES),
        )
        self._loads = c.pinwheel_law_loads
        self.calls = 0

    def evaluate(self) -> None:
        """Evaluates the contact loads of `states` into `loads`."""
        self.calls += 1
        self._check(self._loads(*self._arguments))

    def load_torque(self, time_s: float) -> float:
        """Load on the output shaft, N m, counter-clockwise positive."""
        return float(self._c.pinwheel_law_load_torque(self._handle, time_s))

    def close(self) -> None:
        """Frees the law's scene, which also reports the number of the law's evaluations to the harness."""
        self._c.pinwheel_law_close(self._handle)

    def _check(self, status: int) -> None:
        if status < 0:
            words = (self._c.pinwheel_law_error() or b"").decode()
            raise DivergedError(words) if status == NOT_FINITE else RuntimeError(words)


class Mechanism:
    """Bodies, joints and driver of a job as a stabilised DAE."""

    def __init__(self, job: dict[str, Any], law: Law) -> None:
        self.law = law
        bodies = job["bodies"]
        self.count = n = len(bodies)
        self.carriers = np.array([body["carrier"] for body in bodies])
        self.seats = np.array([body["seat_m"] for body in bodies])
        self.start = np.array([body["start"] for body in bodies])
        self.motions = motions(job["scene"]["drive"])
        self.phase = self.start[INPUT, 2]
        mass = [(body["mass_kg"], body["mass_kg"], body["moment_kg_m2"]) for body in bodies]
        self.mass = np.array(mass).ravel()
        # Two constraints a revolute, one for the driver: g = x - x_carrier - R seat. Free bodies have none.
        self.pinned = np.nonzero(self.carriers != FREE)[0]
        self.coordinates, self.constraints = 3 * n, 2 * self.pinned.size + 1
        self.gradient = np.zeros((self.constraints, self.coordinates))
        for pin, body in enumerate(self.pinned):
            carrier = self.carriers[body]
            for axis in range(2):
                self.gradient[2 * pin + axis, 3 * body + axis] = 1.0
                if carrier >= 0:
                    self.gradient[2 * pin + axis, 3 * carrier + axis] = -1.0
        self.gradient[-1, 3 * INPUT + 2] = 1.0
        self.carried = np.nonzero(self.carriers >= 0)[0]
        self.holders = self.carriers[self.carried]
        # Pins that bodies carry.
        self.held = np.nonzero(self.carriers[self.pinned] >= 0)[0]
        self.rows, self.columns = 2 * self.held, 3 * self.holders + 2
        q, v, lam = (slice(k * self.coordinates, (k + 1) * self.coordinates) for k in range(3))
        lam = slice(v.stop, v.stop + self.constraints)
        mu = slice(lam.stop, lam.stop + self.constraints)
        self.parts, self.size = (q, v, lam, mu), mu.stop
        # A body's centre moves with its carrier, and stays where it is on the housing or the driven input.
        held = (self.carriers < OUTPUT) & (self.carriers != FREE)
        self.free = [(2, 5) if still else range(6) for still in held]
        self.leg = (0.0, np.inf)
        # Increments of coordinates and velocities for finite differences of contact loads.
        self.nudge = np.ones(6)
        self.attempts = 0
        self._last = np.nan

    def input(self, time_s: float) -> tuple[float, float, float]:
        """Angle, speed and acceleration of the driver; at an end of a ramp those that begin."""
        # Times of samples and changes differ by rounding.
        from_s, angle, rate, acceleration = [m for m in self.motions if m[0] <= time_s * (1.0 + 1e-12)][-1]
        since = time_s - from_s
        return angle + since * (rate + 0.5 * since * acceleration), rate + since * acceleration, acceleration

    def arms(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Seats of carried bodies in the ground frame, and the gradient with the columns of their carriers' angles."""
        angle = q[self.columns]
        cos, sin = np.cos(angle), np.sin(angle)
        x, y = self.seats[self.carried].T
        arms = np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)
        self.gradient[self.rows, self.columns] = arms[:, 1]
        self.gradient[self.rows + 1, self.columns] = -arms[:, 0]
        return arms, self.gradient

    def gaps(self, time_s: float, q: np.ndarray, arms: np.ndarray) -> np.ndarray:
        """Constraints at position level."""
        g = np.empty(self.constraints)
        positions = q.reshape(-1, 3)[:, :2]
        joints = g[:-1].reshape(-1, 2)
        joints[:] = (positions - self.seats)[self.pinned]
        joints[self.held] = positions[self.carried] - positions[self.holders] - arms
        g[-1] = q[3 * INPUT + 2] - self.phase - self.input(time_s)[0]
        return g

    def forces(self, time_s: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Contact loads and the output's load."""
        law = self.law
        law.states[:, :3], law.states[:, 3:] = q.reshape(-1, 3), v.reshape(-1, 3)
        law.evaluate()
        f = law.loads.ravel().copy()
        # A step belongs to one side of a jump of the load.
        f[3 * OUTPUT + 2] += law.load_torque(min(max(time_s, self.leg[0]), self.leg[1]))
        return f

    def residual(self, t: float, y: np.ndarray, yp: np.ndarray, res: np.ndarray) -> None:
        """Residual of the complete DAE."""
        self.attempts += t != self._last
        self._last = t
        iq, iv, il, im = self.parts
        q, v = y[iq], y[iv]
        arms, gradient = self.arms(q)
        res[iq] = yp[iq] - v + y[im] @ gradient
        res[iv] = self.mass * yp[iv] - self.forces(t, q, v) + y[il] @ gradient
        res[il] = self.gaps(t, q, arms)
        res[im] = gradient @ v
        res[im.stop - 1] -= self.input(t)[1]

    def jacobian(self, t: float, y: np.ndarray, _yp: np.ndarray, _res: np.ndarray, cj: float, jacobian: np.ndarray) -> None:
        """d res/dy + cj d res/dy'; contact loads by forward differences, the rest exactly."""
        iq, iv, il, im = self.parts
        q, v = y[iq], y[iv]
        arms, gradient = self.arms(q)
        jacobian[:] = 0.0
        every = np.arange(self.coordinates)
        jacobian[every, every] = cj
        jacobian[every, self.coordinates + every] = -1.0
        jacobian[iv, iv][every, every] = cj * self.mass
        jacobian[iq, im] = jacobian[iv, il] = gradient.T
        jacobian[il, iq] = jacobian[im, iv] = gradient
        # G depends on the carriers' angles.
        for at, arm, column in zip(self.rows, arms, self.columns, strict=True):
            for block, multipliers in ((iq, im), (iv, il)):
                pull = y[multipliers][at : at + 2]
                jacobian[block.start + column, column] += arm @ pull
            jacobian[im.start + at : im.start + at + 2, column] += arm * v[column]
        self._add_stiffness(t, q, v, jacobian)

    def _add_stiffness(self, t: float, q: np.ndarray, v: np.ndarray, jacobian: np.ndarray) -> None:
        _, iv, _, _ = self.parts
        law = self.law
        self.forces(t, q, v)
        at = law.loads.copy()
        for body in range(OUTPUT + 1, self.count):
            for place in self.free[body]:
                kept = law.states[body, place]
                law.states[body, place] += self.nudge[place]
                law.evaluate()
                law.states[body, place] = kept
                column = 3 * body + place if place < 3 else self.coordinates + 3 * body + place - 3
                jacobian[iv, column] -= ((law.loads - at) / self.nudge[place]).ravel()

    def multipliers(self, time_s: float, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations and multipliers that positions and velocities demand."""
        arms, gradient = self.arms(q)
        demanded = np.zeros(self.constraints)
        demanded[:-1].reshape(-1, 2)[self.held] = -arms * v[self.columns, None] ** 2
        demanded[-1] = self.input(time_s)[2]
        free = self.forces(time_s, q, v) / self.mass
        light = gradient / self.mass
        pull = np.linalg.solve(light @ gradient.T, gradient @ free - demanded)
        return free - pull @ light, pull


class Courses:
    """The contract's courses, one row a sample."""

    def __init__(self, mechanism: Mechanism, path: Path, gear: dict[str, Any]) -> None:
        carriers, first = mechanism.carriers, mechanism.count - gear["external_sleeves"] - gear["internal_sleeves"]
        self.sleeves = np.arange(first, mechanism.count)
        self.on_output = np.nonzero(carriers == OUTPUT)[0]
        columns = ["time_s", "input_torque_n_m", "output_torque_n_m", "output_angle_rad"]
        rates, bodies = [], iter(self.sleeves)
        for kind in ("external", "internal"):
            for k in range(gear[f"{kind}_sleeves"]):
                body = next(bodies)
                columns.append(f"{kind}_sleeve_force_n_{k}")
                # Pins that the output holds turn as it does.
                held = carriers[body] == OUTPUT and not gear.get(f"{kind}_sleeves_turn", True)
                rates.append((f"{kind}_sleeve_rate_rad_s_{k}", OUTPUT if held else body, 5))
        # States: places and angles, then velocities and rates.
        kinds = ["x_m", "y_m", "angle_rad", "velocity_x_m_s", "velocity_y_m_s", "rate_rad_s"]
        discs = list(enumerate(range(OUTPUT + 1, first)))
        wheels = [(f"wheel_{name}_{k}", body, place) for place, name in enumerate(kinds) for k, body in discs]
        states = [("output_rate_rad_s", OUTPUT, 5), *wheels, *rates]
        columns += [name for name, _, _ in states]
        self.places = [(body, place) for _, body, place in states]
        self.file = path.open("w", encoding="ascii")
        print(*columns, sep=",", file=self.file)

    def row(self, time_s: float, input_torque: float, states: np.ndarray, loads: np.ndarray) -> None:
        """Writes one sample, from states and contact loads of all bodies."""
        arm, force = states[self.on_output, :2] - states[OUTPUT, :2], loads[self.on_output, :2]
        # Couples of sleeves on their pins, and the seal.
        own = loads[OUTPUT, 2]
        output_torque = own + float(np.sum(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]))
        sleeves = np.hypot(loads[self.sleeves, 0], loads[self.sleeves, 1])
        values = [time_s, input_torque, output_torque, states[OUTPUT, 2], *sleeves, *(states[at] for at in self.places)]
        print(*(repr(float(value)) for value in values), sep=",", file=self.file)


def motions(drive: dict[str, Any]) -> list[tuple[float, float, float, float]]:
    """Returns start, angle, speed and acceleration of each stretch of the input's motion."""
    speed = drive["input_speed_rad_s"]
    pieces = [(0.0, 0.0, speed, 0.0)]
    for change in drive.get("speed_changes") or []:
        time, ramp, after = change["time_s"], change["ramp_s"], change["input_speed_rad_s"]
        begin = pieces[-1][1] + speed * (time - pieces[-1][0])
        pieces.append((time, begin, speed, (after - speed) / ramp))
        pieces.append((time + ramp, begin + 0.5 * (speed + after) * ramp, after, 0.0))
        speed = after
    return pieces


def legs(drive: dict[str, Any], samples: list[float]) -> list[tuple[float, float]]:
    """Returns the times of cuts of the run, jumps and kinks of load and speed and its end, by both clocks.

    A sample within rounding of a cut stands for it on the second clock.
    """
    breaks = {drive["load_ramp_s"]}
    for change in [*(drive.get("load_changes") or []), *(drive.get("speed_changes") or [])]:
        breaks |= {change["time_s"], change["time_s"] + (change.get("ramp_s") or 0.0)}
    cuts = []
    for time in sorted(breaks):
        near = min(samples, key=lambda sample: abs(sample - time))
        at = near if abs(near - time) <= 1e-9 * samples[-1] else time
        if 0.0 < at < samples[-1]:
            cuts.append((time, at))
    return [*cuts, (samples[-1], samples[-1])]


def run(job: Path, library: str) -> None:
    """Runs one job."""
    description = json.loads((job / "scene.json").read_text(encoding="utf-8"))
    scene, samples = description["scene"], description["samples_s"]
    law = Law(library, job)
    mechanism = Mechanism(description, law)
    iq, iv, il, im = mechanism.parts

    # Errors are judged by the elastic twist, not by angles that grow to radians; multipliers are not judged.
    twist, vibration = description["elastic_twist_rad"], description["vibration_rad_s"]
    eccentricity = float(np.hypot(*mechanism.start[OUTPUT + 1, :2]))
    # BDF's errors add up over thousands of steps.
    tolerance = 0.1 * scene["solver"]["tolerance"]
    size = np.tile([eccentricity * twist, eccentricity * twist, twist], mechanism.count)
    mechanism.nudge = 1e-6 * np.concatenate([size[:3], vibration * size[:3]])
    weights = np.full(mechanism.size, 1e30)
    weights[iq], weights[iv] = tolerance * size, tolerance * vibration * size

    y, yp = np.zeros(mechanism.size), np.zeros(mechanism.size)
    y[iq], y[iv] = mechanism.start[:, :3].ravel(), mechanism.start[:, 3:].ravel()
    courses = Courses(mechanism, job / "courses.csv", scene["gear"])
    wanted, drift = set(samples), 0.0

    def sample(time_s: float) -> None:
        nonlocal drift
        q, v = y[iq], y[iv]
        _, pull = mechanism.multipliers(time_s, q, v)
        if not np.all(np.isfinite(y)) or not np.all(np.isfinite(pull)):
            raise DivergedError(f"a state is not finite at t = {time_s} s")
        drift = max(drift, float(np.max(np.abs(mechanism.gaps(time_s, q, mechanism.arms(q)[0])))))
        courses.row(time_s, -float(pull[-1]), law.states, law.loads)
        print(f"@t {time_s}", file=sys.stderr, flush=True)

    try:
        sample(0.0)
        begin = load_from = 0.0
        for load_until, end in legs(scene["drive"], samples):
            mechanism.leg = (load_from, float(np.nextafter(load_until, 0.0)))
            acceleration, pull = mechanism.multipliers(begin, y[iq], y[iv])
            yp[:], y[im], y[il] = 0.0, 0.0, pull
            yp[iq], yp[iv] = y[iv], acceleration
            solver = sun.ida.IDA(
                mechanism.residual,
                jacfn=mechanism.jacobian,
                algebraic_idx=list(range(il.start, im.stop)),
                rtol=1e-15,
                atol=weights,
                linsolver="lapackdense",
                max_num_steps=10_000_000,
                first_step=1e-3 / vibration,
            )
            solver.init_step(begin, y, yp)
            inside = [time for time in samples if begin < time < end]
            for target in [*inside, end]:
                step = solver.step(target, tstop=end)
                if not step.success:
                    raise DivergedError(f"IDA gives up at t = {step.t} s: {step.message}")
                y[:], yp[:] = step.y, step.yp
                if target in wanted:
                    sample(target)
            begin, load_from = end, load_until
    finally:
        courses.file.close()
        result = {
            "steps": mechanism.attempts,
            "right_hand_sides": law.calls,
            "degrees_of_freedom": mechanism.size,
            "settings": f"IDA BDF, {mechanism.constraints} constraints, stabilised index 2, tolerance {tolerance:g}",
            "joint_drift_m": drift,
        }
        (job / "result.json").write_text(json.dumps(result), encoding="utf-8")
        law.close()


def main() -> int:
    """Runs the job on the command line; returns the exit status."""
    if len(sys.argv) != 3:
        print("usage: python ida.py JOB LAW", file=sys.stderr)
        return USAGE
    try:
        run(Path(sys.argv[1]), sys.argv[2])
    except DivergedError as error:
        print(error, file=sys.stderr)
        return DIVERGED
    return FINISHED


if __name__ == "__main__":
    sys.exit(main())
