"""A solver in Python: Heun's method (order 2) at the scene's step, contact forces by libpinwheel_law.

    pinwheel compare paper --solver solver.toml

Everything about the scene comes from the job's scene.json, forces from the library; nothing but the standard library is
needed. All bodies are pinned at their centres, so each has one unknown: its angle. The input turns at a constant rate.
"""

import ctypes
import json
import math
import sys
from pathlib import Path

job, library = Path(sys.argv[1]), sys.argv[2]
scene = json.loads((job / "scene.json").read_text(encoding="utf-8"))
if scene["protocol"] != 1:
    sys.exit("this solver speaks protocol 1")

law = ctypes.CDLL(library)
law.pinwheel_law_error.restype = ctypes.c_char_p
law.pinwheel_law_load_torque.restype = ctypes.c_double
law.pinwheel_law_load_torque.argtypes = [ctypes.c_void_p, ctypes.c_double]
law.pinwheel_law_close.argtypes = [ctypes.c_void_p]
handle = ctypes.c_void_p()
if law.pinwheel_law_open(str(job).encode(), ctypes.byref(handle)) != 0:
    sys.exit(law.pinwheel_law_error().decode())

bodies = scene["bodies"]
count = len(bodies)
rate = scene["rate_rad_s"]
carrier = [body["carrier"] for body in bodies]
seat = [body["seat_m"] for body in bodies]
moment = [body["moment_kg_m2"] for body in bodies]
wheels = [k for k in range(2, count) if carrier[k] == 0]
internal = [k for k in range(2, count) if carrier[k] == 1]
sleeves = [k for k in range(2, count) if carrier[k] != 0]
output_moment = moment[1] + sum(bodies[k]["mass_kg"] * math.hypot(*seat[k]) ** 2 for k in internal)
states = (ctypes.c_double * (6 * count))()
loads = (ctypes.c_double * (3 * count))()


def turning(k):
    """Moment about the origin of the contact force on body k."""
    return states[6 * k] * loads[3 * k + 1] - states[6 * k + 1] * loads[3 * k]


def slopes(time, angles, rates):
    """Fills states and loads; returns the derivatives of the rates."""
    angles[0], rates[0] = rate * time, rate
    turned = {-1: (1.0, 0.0, 0.0)}
    for k in (0, 1):
        turned[k] = (math.cos(angles[k]), math.sin(angles[k]), rates[k])
    row = []
    for k in range(count):
        c, s, spin = turned[carrier[k]]
        u, v = seat[k]
        x, y = c * u - s * v, s * u + c * v
        row += (x, y, angles[k], -spin * y, spin * x, rates[k])
    states[:] = row
    if law.pinwheel_law_loads(handle, states, loads) != 0:
        print("no forces:", law.pinwheel_law_error().decode(), file=sys.stderr)
        sys.exit(3)
    torque = loads[5] + law.pinwheel_law_load_torque(handle, time) + sum(map(turning, internal))
    return [0.0, torque / output_moment] + [loads[3 * k + 2] / moment[k] for k in range(2, count)]


def moved(values, step, derivatives):
    return [value + step * derivative for value, derivative in zip(values, derivatives)]


angles = [body["start"][2] for body in bodies]
rates = [body["start"][5] for body in bodies]
times = scene["samples_s"]
longest = scene["scene"]["solver"]["step_s"]
all_steps = 0
with open(job / "courses.csv", "w", encoding="utf-8") as courses:
    columns = ["time_s", "input_torque_n_m", "output_torque_n_m", "output_angle_rad"]
    columns += [f"external_sleeve_force_n_{j}" for j in range(len(sleeves) - len(internal))]
    columns += [f"internal_sleeve_force_n_{j}" for j in range(len(internal))]
    # States: with them Pinwheel says which part of a solver differs.
    external = len(sleeves) - len(internal)
    columns += ["output_rate_rad_s"] + [f"wheel_angle_rad_{j}" for j in range(len(wheels))]
    columns += [f"wheel_rate_rad_s_{j}" for j in range(len(wheels))]
    columns += [f"external_sleeve_rate_rad_s_{j}" for j in range(external)]
    columns += [f"internal_sleeve_rate_rad_s_{j}" for j in range(len(internal))]
    print(*columns, sep=",", file=courses)
    for sample, time in enumerate(times):
        slopes(time, angles, rates)
        driver = -loads[2] - sum(map(turning, wheels))
        output = loads[5] + sum(map(turning, internal))
        forces = [math.hypot(loads[3 * k], loads[3 * k + 1]) for k in sleeves]
        state = [rates[1], *(angles[k] for k in wheels), *rates[2:]]
        print(time, driver, output, angles[1], *forces, *state, sep=",", file=courses)
        if sample % 100 == 0:
            print("@t", time, file=sys.stderr)
        if time == times[-1]:
            break
        # Whole steps to the next sample, no longer than the scene's.
        length = times[sample + 1] - time
        steps = math.ceil(length / longest * (1 - 1e-9))
        h = length / steps
        for step in range(steps):
            t = time + step * h
            first = slopes(t, angles, rates)
            second_rates = moved(rates, h, first)
            second = slopes(t + h, moved(angles, h, rates), second_rates)
            mean_rates = [(a + b) / 2 for a, b in zip(rates, second_rates)]
            angles = moved(angles, h, mean_rates)
            rates = moved(rates, h, [(a + b) / 2 for a, b in zip(first, second)])
        all_steps += steps

result = {"steps": all_steps, "degrees_of_freedom": count - 1, "settings": "Heun"}
(job / "result.json").write_text(json.dumps(result), encoding="utf-8")
law.pinwheel_law_close(handle)
