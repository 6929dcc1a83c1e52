"""Solves the problem of description.html from its text alone: `python solve.py mine.csv [end, s]`. Needs numpy.

The equations of motion of section 3 in three angles, the classical Runge-Kutta method in steps of 5e-6 s.
"""

import sys
import time

import numpy as np

OMEGA, LOAD = 52.34, 22.0
E, RATIO, N_EXTERNAL, N_INTERNAL, WHEELS = 0.0028, 0.7, 16, 8, 2
Q, R_HOLE, R_CIRCLE = 0.006, 0.0088, 0.038
YOUNG, POISSON, SOFTER, C, RAMP = 2e11, 0.3, 0.01, 8.0, 1e-5
J_WHEEL, J_OUTPUT = 0.000157538, 0.0001373 + N_INTERNAL * 0.048 * R_CIRCLE**2
STEP, SAMPLE = 5e-6, 2e-3

LOBES = N_EXTERNAL - 1
R = E * N_EXTERNAL / RATIO
HERTZ = SOFTER * 4.0 / 3.0 * YOUNG / (2.0 * (1.0 - POISSON**2))
PINS = R * np.exp(2j * np.pi * np.arange(N_EXTERNAL) / N_EXTERNAL)
HOLES = R_CIRCLE * np.exp(2j * np.pi * np.arange(N_INTERNAL) / N_INTERNAL)
PHASES = 2.0 * np.pi * np.arange(WHEELS)[:, None] / WHEELS
START = (np.pi - PHASES) / LOBES
GRID = 2.0 * np.pi * np.arange(480) / 480


def curve(a):
    """C, C' and C'' of the pins' path in a wheel's frame."""
    one, two = R * np.exp(1j * a), E * np.exp(1j * N_EXTERNAL * a)
    return one + two, 1j * (one + N_EXTERNAL * two), -(one + N_EXTERNAL**2 * two)


POINTS = curve(GRID)[0]


def dot(a, b):
    return (a.conjugate() * b).real


def cross(a, b):
    return (a.conjugate() * b).imag


def force(stiffness, depth, rate):
    inside = np.clip(depth, 0.0, None)
    return np.clip(np.clip(inside / RAMP, None, 1.0) * (stiffness * inside**1.5 + C * rate), 0.0, None)


def forces(t, y):
    """Forces on the pins by each wheel, on the rollers by each wheel, and where these and the wheels' centres are."""
    turn, spin, output, rate = y[:WHEELS, None], y[WHEELS + 1 : 2 * WHEELS + 1, None], y[WHEELS], y[-1]
    centre = E * np.exp(1j * (OMEGA * t + PHASES))
    frame = np.exp(1j * turn)

    def velocity(point):
        return 1j * OMEGA * centre + 1j * spin * (point - centre)

    # Pins: the nearest point of C, by a grid and Newton's method.
    local = (PINS - centre) / frame
    a = GRID[np.abs(local[..., None] - POINTS).argmin(-1)]
    for _ in range(4):
        c, c1, c2 = curve(a)
        a = a - dot(c - local, c1) / (dot(c1, c1) + dot(c - local, c2))
    c, c1, c2 = curve(a)
    outward = -1j * c1 / np.abs(c1)
    curvature = cross(c1, c2) / np.abs(c1) ** 3
    normal = -outward * frame
    point = centre + frame * (c - Q * outward)
    stiffness = HERTZ * np.sqrt(Q * np.clip(1.0 - Q * curvature, 0.0, None))
    on_pins = -normal * force(stiffness, dot(c - local, outward), -dot(velocity(point), normal))

    # Rollers of the output in the wheels' holes.
    rollers = HOLES * np.exp(1j * output)
    hole = centre + HOLES * np.exp(1j * (turn - START))
    off = rollers - hole
    normal = off / np.abs(off)
    at = hole + R_HOLE * normal
    speed = dot(1j * rate * at - velocity(at), normal)
    stiffness = HERTZ * np.sqrt(Q * R_HOLE / (R_HOLE - Q))
    on_rollers = -normal * force(stiffness, np.abs(off) - (R_HOLE - Q), speed)
    return on_pins, point, on_rollers, at, rollers, centre


def slope(t, y):
    on_pins, point, on_rollers, at, rollers, centre = forces(t, y)
    wheel = -(cross(point - centre, on_pins).sum(-1) + cross(at - centre, on_rollers).sum(-1))
    output = LOAD + cross(rollers, on_rollers).sum()
    return np.concatenate([y[WHEELS + 1 :], wheel / J_WHEEL, [output / J_OUTPUT]])


def row(t, y):
    on_pins, _, on_rollers, _, rollers, centre = forces(t, y)
    on_wheels = -(on_pins.sum(-1) + on_rollers.sum(-1))
    driver = -cross(centre[:, 0], on_wheels).sum()
    sleeves = np.concatenate([np.abs(on_pins.sum(0)), np.abs(on_rollers.sum(0))])
    return [t, driver, cross(rollers, on_rollers).sum(), y[WHEELS], *sleeves]


def main(path, end=0.6):
    begun = time.process_time()
    rate = -OMEGA / LOBES
    y = np.concatenate([START[:, 0], [0.0], np.full(WHEELS + 1, rate)])
    rows = [row(0.0, y)]
    for k in range(round(end / STEP)):
        t = k * STEP
        k1 = slope(t, y)
        k2 = slope(t + STEP / 2, y + STEP / 2 * k1)
        k3 = slope(t + STEP / 2, y + STEP / 2 * k2)
        k4 = slope(t + STEP, y + STEP * k3)
        y = y + STEP / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if (k + 1) % round(SAMPLE / STEP) == 0:
            rows.append(row((k + 1) * STEP, y))
    names = ["time_s", "input_torque_n_m", "output_torque_n_m", "output_angle_rad"]
    names += [f"external_sleeve_force_n_{k}" for k in range(N_EXTERNAL)]
    names += [f"internal_sleeve_force_n_{k}" for k in range(N_INTERNAL)]
    np.savetxt(path, rows, "%.12g", ",", header=",".join(names), comments="")
    print(f"{time.process_time() - begun:.1f} s of processor time")


if __name__ == "__main__":
    main(sys.argv[1], *map(float, sys.argv[2:]))
