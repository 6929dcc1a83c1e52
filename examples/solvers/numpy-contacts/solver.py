"""A solver in Python with contacts of its own: Runge-Kutta 4 at the scene's step, contact search and law in numpy.

    pinwheel compare paper --solver solver.toml

Start, masses and bodies come from the job's scene.json, forces from the equations of docs/physics.md. Plane vectors are complex
numbers. All bodies are pinned at their centres, so each has one unknown: its angle. The input turns at a constant rate.
"""

import json
import math
import sys
from pathlib import Path

import numpy as np

job = Path(sys.argv[1])
text = json.loads((job / "scene.json").read_text(encoding="utf-8"))
if text["protocol"] != 1:
    sys.exit("this solver speaks protocol 1")
scene, bodies = text["scene"], text["bodies"]
gear, contact = scene["gear"], scene["contact"]


def numbers(of):
    """All numbers of a table, its lists and tables included."""
    if isinstance(of, dict | list):
        return [number for part in (of.values() if isinstance(of, dict) else of) for number in numbers(part)]
    return [of]


beyond = {
    "contact.detection": contact["detection"] != "exact",
    "contact.friction_law": contact["friction_law"] != "regularised",
    "contact materials": any(key.startswith(("pin_", "disc_")) for key in contact),
    "gear.errors": any(numbers(gear["errors"])),
    "gear.modification": any(numbers(gear["modification"])),
    "pins that do not turn": not (gear["external_sleeves_turn"] and gear["internal_sleeves_turn"]),
    "bearings": "bearings" in scene,
}
if any(beyond.values()):
    print("it has no", ", ".join(key for key, asked in beyond.items() if asked), file=sys.stderr)
    sys.exit(4)

rate = text["rate_rad_s"]
carrier = np.array([body["carrier"] for body in bodies])
seat = np.array([complex(*body["seat_m"]) for body in bodies])
mass = np.array([body["mass_kg"] for body in bodies])
moment = np.array([body["moment_kg_m2"] for body in bodies])
number = np.arange(len(bodies))
discs, inner = number[carrier == 0], number[carrier == 1]
outer = number[(carrier == -1) & (number > 1)]
moment[1] += sum(mass[inner] * abs(seat[inner]) ** 2)

# The curve C(a) = R e^ia + e e^(i zk a) on which the centres of ring pins in contact lie, and the holes in the discs' frames.
zk, e, m = gear["external_sleeves"], gear["eccentricity_m"], gear["shortening"]
R, q = e * zk / m, gear["external_sleeve_radius_m"]
r, hole = gear["internal_sleeve_radius_m"], gear["hole_radius_m"]
meshed = (math.pi - 2 * math.pi * np.arange(len(discs)) / len(discs)) / (zk - 1)
holes = gear["internal_circle_radius_m"] * np.exp(
    1j * (2 * math.pi * np.arange(len(inner)) / len(inner) - meshed[:, None])
)
# K = factor sqrt(effective radius), the same material on both sides.
compliance = (1 - contact["poisson"] ** 2) / (math.pi * contact["young_pa"])
factor = 4 * contact["stiffness_multiplier"] / (3 * math.pi * 2 * compliance)


def dot(a, b):
    return (a * b.conjugate()).real


def cross(a, b):
    return (a.conjugate() * b).imag


def closest(p):
    """Angles of the closest points of C, and where the points p are inside of C: only there can they touch."""
    polar = np.angle(p)
    a = polar.copy()
    for _ in range(8):  # the point of C in the direction of p, by Newton's method
        wave = m / zk * np.exp(1j * (zk - 1) * a)
        off = np.angle(np.exp(1j * (a - polar)) * (1 + wave))
        a -= off / (1 + (zk - 1) * (wave.real + (m / zk) ** 2) / abs(1 + wave) ** 2)
    inside = abs(p) < abs(R * np.exp(1j * a) + e * np.exp(1j * zk * a))
    a, p = a[inside], p[inside]
    for _ in range(6):  # the foot of the perpendicular
        turn, wave = np.exp(1j * a), np.exp(1j * (zk - 1) * a)
        first, second = 1j * R * turn * (1 + m * wave), -R * turn * (1 + zk * m * wave)
        gap = p - R * turn - e * turn * wave
        a += dot(gap, first) / (dot(first, first) - dot(gap, second))
    return a, inside


def forces(place, speed, angle, spin):
    """Contact forces on all bodies, and their moments about the bodies' centres."""
    turned = np.exp(1j * angle[discs])[:, None]
    contacts = []
    # Ring pins on the profiles.
    a, inside = closest((place[outer] - place[discs][:, None]) / turned)
    disc, pin = np.nonzero(inside)
    turn, wave = np.exp(1j * a), np.exp(1j * (zk - 1) * a)
    first, second = 1j * R * turn * (1 + m * wave), -R * turn * (1 + zk * m * wave)
    out = turned[disc, 0] * first / abs(first) / 1j
    on_curve = place[discs[disc]] + turned[disc, 0] * (R * turn + e * turn * wave)
    curvature = cross(first, second) / abs(first) ** 3
    depth = -dot(place[outer[pin]] - on_curve, out)
    contacts.append((discs[disc], outer[pin], on_curve - q * out, -out, depth, q * (1 - q * curvature)))
    # Output pins in the holes.
    centre = place[discs][:, None] + turned * holes
    gap = place[inner] - centre
    n = gap / abs(gap)
    depth = r - hole + abs(gap)
    disc, pin = np.nonzero(depth > 0)
    at = (disc, pin)
    contacts.append((discs[disc], inner[pin], (centre + hole * n)[at], n[at], depth[at], r * hole / (hole - r)))

    force, turning = np.zeros(len(bodies), complex), np.zeros(len(bodies))
    for disc, pin, w, n, depth, radius in contacts:
        sliding = speed[pin] + 1j * spin[pin] * (w - place[pin]) - speed[disc] - 1j * spin[disc] * (w - place[disc])
        depth = np.maximum(depth, 0)
        share = np.minimum(depth / contact["ramp_m"], 1)
        normal = share * (factor * np.sqrt(radius) * depth**1.5 + contact["damping_n_s_m"] * dot(sliding, n))
        normal = np.maximum(normal, 0)
        slip = np.clip(dot(sliding, 1j * n) / contact["friction_ramp_m_s"], -1, 1)
        on_pin = -normal * n - contact["friction_coefficient"] * normal * slip * 1j * n
        for body, pull in ((pin, on_pin), (disc, -on_pin)):
            np.add.at(force, body, pull)
            np.add.at(turning, body, cross(w - place[body], pull))
    return force, turning


def evaluate(t, y):
    """Places, forces and moments at time t from angles and rates, and their derivatives."""
    angle, spin = y[0].copy(), y[1].copy()
    angle[0], spin[0] = rate * t, rate
    held = carrier >= 0
    place = np.where(held, seat * np.exp(1j * angle[carrier]), seat)
    speed = np.where(held, 1j * spin[carrier] * place, 0)
    force, turning = forces(place, speed, angle, spin)
    turning[1] = sum(cross(place[inner], force[inner])) + turning[1]
    drive = scene["drive"]
    ramp = drive["load_ramp_s"]
    load = drive["output_torque_n_m"] * (min(t / ramp, 1) if ramp > 0 else 1)
    torque = turning.copy()
    torque[1] += load
    acceleration = torque / moment
    acceleration[0] = 0
    return np.array([spin, acceleration]), place, force, turning


y = np.array([[body["start"][2] for body in bodies], [body["start"][5] for body in bodies]])
times, longest, all_steps = text["samples_s"], scene["solver"]["step_s"], 0
with open(job / "courses.csv", "w", encoding="utf-8") as courses:
    columns = ["time_s", "input_torque_n_m", "output_torque_n_m", "output_angle_rad"]
    columns += [f"external_sleeve_force_n_{k}" for k in range(len(outer))]
    columns += [f"internal_sleeve_force_n_{k}" for k in range(len(inner))]
    # States: with them Pinwheel says which part of a solver differs.
    columns += ["output_rate_rad_s"] + [f"wheel_angle_rad_{k}" for k in range(len(discs))]
    columns += [f"wheel_rate_rad_s_{k}" for k in range(len(discs))]
    columns += [f"external_sleeve_rate_rad_s_{k}" for k in range(len(outer))]
    columns += [f"internal_sleeve_rate_rad_s_{k}" for k in range(len(inner))]
    print(*columns, sep=",", file=courses)
    for sample, time in enumerate(times):
        _, place, force, turning = evaluate(time, y)
        driver = -sum(cross(place[discs], force[discs]))
        pins = abs(force[np.concatenate([outer, inner])])
        row = [time, driver, turning[1], y[0, 1], *pins, y[1, 1], *y[0, discs], *y[1, 2:]]
        print(*map(float, row), sep=",", file=courses)
        if sample % 100 == 0:
            print("@t", time, file=sys.stderr)
        if time == times[-1]:
            break
        # Whole steps to the next sample, no longer than the scene's.
        length = times[sample + 1] - time
        steps = math.ceil(length / longest * (1 - 1e-9))
        h = length / steps
        for t in time + h * np.arange(steps):
            k1 = evaluate(t, y)[0]
            k2 = evaluate(t + h / 2, y + h / 2 * k1)[0]
            k3 = evaluate(t + h / 2, y + h / 2 * k2)[0]
            k4 = evaluate(t + h, y + h * k3)[0]
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if not np.isfinite(y).all():
            print("numbers ran away", file=sys.stderr)
            sys.exit(3)
        all_steps += steps

result = {"steps": all_steps, "right_hand_sides": 4 * all_steps + len(times), "settings": "RK4"}
(job / "result.json").write_text(json.dumps(result), encoding="utf-8")
