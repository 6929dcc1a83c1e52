"""Order and places of the bodies, and motion of the mechanism without contact.

Body order everywhere: input shaft, output shaft, discs, ring pins, output pins. One body's state is
(x, y, angle, vx, vy, rate) of its centre of mass, one body's load (fx, fy, moment about it), ground frame, SI.

Every body turns about its own centre of mass, which its carrier holds: discs sit on the input shaft's eccentrics,
output pins on the output shaft (ring pins, if the ring is the output), everything else on the ground. So a state is
known from one absolute angle a body, in the order of the bodies; these angles are the *joint angles* `phi` of this
package.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pinwheel_engines.scene import Gear, Scene

Floats = npt.NDArray[np.float64]

INPUT = 0
OUTPUT = 1


@dataclass(frozen=True)
class Layout:
    """Body indices of one gear."""

    wheels: int
    external_sleeves: int
    internal_sleeves: int
    ring_turns: bool = False

    @staticmethod
    def of(gear: Gear) -> Layout:
        """The layout of a gear."""
        return Layout(gear.wheels, gear.external_sleeves, gear.internal_sleeves, gear.ring_turns)

    @property
    def wheel_bodies(self) -> slice:
        """All discs."""
        return slice(2, 2 + self.wheels)

    @property
    def external_bodies(self) -> slice:
        """All ring pins."""
        start = 2 + self.wheels
        return slice(start, start + self.external_sleeves)

    @property
    def internal_bodies(self) -> slice:
        """All output pins."""
        start = 2 + self.wheels + self.external_sleeves
        return slice(start, start + self.internal_sleeves)

    @property
    def output_bodies(self) -> slice:
        """The pins on the output: ring pins if the ring is the output."""
        return self.external_bodies if self.ring_turns else self.internal_bodies

    @property
    def bodies(self) -> int:
        """Number of bodies."""
        return 2 + self.wheels + self.external_sleeves + self.internal_sleeves

    @property
    def carriers(self) -> list[int]:
        """The body each body is pinned to; -1 is the ground."""
        on = [-1] * self.bodies
        on[self.wheel_bodies] = [INPUT] * self.wheels
        pins = self.output_bodies
        on[pins] = [OUTPUT] * (pins.stop - pins.start)
        return on


class Kinematics:
    """Positions and velocities of all bodies from their absolute angles, and loads back to torques on those angles.

    Discs that float (`floats`) have no carrier; where they are comes from elsewhere.
    """

    def __init__(self, gear: Gear, floats: bool = False) -> None:
        self.gear, self.floats = gear, floats
        self.layout = Layout.of(gear)
        layout = self.layout
        self.carriers = np.array(layout.carriers)
        if floats:
            self.carriers[layout.wheel_bodies] = -1
        # Position of each body's centre on its carrier (or the ground), m, as complex numbers.
        self.offsets = np.zeros(layout.bodies, dtype=np.complex128)
        eccentricity = gear.eccentricity_m + gear.errors("eccentricity_m", gear.wheels)
        off_phase = np.exp(1j * gear.errors("phase_rad", gear.wheels))
        self.offsets[layout.wheel_bodies] = eccentricity * turns(gear.wheels) * off_phase
        seats = turns(gear.external_sleeves)
        self.offsets[layout.external_bodies] = _placed(gear, "external_sleeve", gear.pitch_radius_m + gear.backlash_m, seats)
        seats = turns(gear.internal_sleeves)
        self.offsets[layout.internal_bodies] = _placed(gear, "internal_sleeve", gear.internal_circle_radius_m, seats)
        self._x = np.zeros(layout.bodies)
        self._carried = np.nonzero(self.carriers >= 0)[0]
        self._carriers = self.carriers[self._carried]
        self._arms = self.offsets[self._carried]
        # Carried by the input come first, then those by the output.
        self._on_input = 0 if floats else layout.wheels

    def relative(self, absolute: Floats) -> Floats:
        """Joint angles (or rates) against the carrier from absolute ones."""
        joints = absolute.copy()
        joints[self._carried] -= absolute[self._carriers]
        return joints

    def absolute(self, relative: Floats) -> Floats:
        """Absolute angles (or rates) from those against the carrier; carriers stand on the ground."""
        angles = relative.copy()
        angles[self._carried] += relative[self._carriers]
        return angles

    def relative_torques(self, angles: Floats, loads: Floats) -> Floats:
        """Generalised torques, N m, on the joint angles against the carrier; `angles` are absolute.

        Turning a carrier turns what it carries, so a carried body's torque acts on its carrier's joint as well.
        """
        joints = self.torques(angles, loads)
        moments, n = loads[self._carried, 2], self._on_input
        joints[INPUT] += moments[:n].sum()
        joints[OUTPUT] += moments[n:].sum()
        return joints

    def states(self, angles: Floats, rates: Floats, out: Floats | None = None) -> Floats:
        """States (bodies, 6) from absolute angles, rad, and rates, rad/s, of all bodies."""
        if out is None:
            out = np.zeros((self.layout.bodies, 6))
        arm = self._arms * np.exp(1j * angles[self._carriers])
        swing = 1j * rates[self._carriers] * arm
        out[:, 0], out[:, 1], out[:, 3:5] = self.offsets.real, self.offsets.imag, 0.0
        out[self._carried, 0], out[self._carried, 1] = arm.real, arm.imag
        out[self._carried, 3], out[self._carried, 4] = swing.real, swing.imag
        out[:, 2], out[:, 5] = angles, rates
        return out

    def torques(self, angles: Floats, loads: Floats, out: Floats | None = None) -> Floats:
        """Generalised torques (bodies,), N m, on the absolute angles from loads (bodies, 3): the transpose of `states`.

        A carried body's force acts on its carrier's angle with the lever of the carrier's arm.
        """
        if out is None:
            out = np.zeros(self.layout.bodies)
        out[:] = loads[:, 2]
        arm = self._arms * np.exp(1j * angles[self._carriers])
        lever = arm.real * loads[self._carried, 1] - arm.imag * loads[self._carried, 0]
        n = self._on_input
        out[INPUT] += lever[:n].sum()
        out[OUTPUT] += lever[n:].sum()
        return out

    def lumped_moments(self, scene: Scene) -> Floats:
        """Diagonal of the exact mass matrix in the absolute angles, kg m^2: carried masses lumped into their carrier."""
        layout, mass = self.layout, scene.mass
        moments = np.zeros(layout.bodies)
        pin = mass.external_sleeve if layout.ring_turns else mass.internal_sleeve
        # Sums of the arms' squares.
        crank, circle = (np.sum(np.abs(self.offsets[part]) ** 2) for part in (layout.wheel_bodies, layout.output_bodies))
        moments[INPUT] = mass.input_shaft.moment_kg_m2 + mass.wheel.mass_kg * crank
        moments[OUTPUT] = mass.output_shaft.moment_kg_m2 + pin.mass_kg * circle
        moments[layout.wheel_bodies] = mass.wheel.moment_kg_m2
        moments[layout.external_bodies] = mass.external_sleeve.moment_kg_m2
        moments[layout.internal_bodies] = mass.internal_sleeve.moment_kg_m2
        return moments

    def ideal(self, scene: Scene, time_s: float = 0.0) -> tuple[Floats, Floats]:
        """Absolute angles and rates of the ideal mesh: output and discs at -omega/zs, with omega of the eccentrics.

        A disc whose centre stands at e (cos f, sin f) fits at the angle (pi - f)/zs. Pins turn with the output that
        carries them, which starts at 0. A ring turns at omega/zk, and discs keep their angles.
        """
        layout, zs, omega = self.layout, self.gear.lobes, scene.drive.input_speed_rad_s
        turning = self.gear.eccentric_per_input * omega
        angles, rates = np.zeros(layout.bodies), np.zeros(layout.bodies)
        angles[INPUT], rates[INPUT] = omega * time_s, omega
        discs, rates[OUTPUT] = (0.0, turning / (zs + 1)) if layout.ring_turns else (-turning / zs, -turning / zs)
        angles[OUTPUT] = rates[OUTPUT] * time_s
        angles[layout.wheel_bodies] = (math.pi - wheel_phases(self.gear)) / zs + discs * time_s
        rates[layout.wheel_bodies] = discs
        angles[layout.output_bodies], rates[layout.output_bodies] = angles[OUTPUT], rates[OUTPUT]
        return angles, rates

    def torque_of_pins(self, angle: float, outer: npt.NDArray[np.complex128], inner: npt.NDArray[np.complex128]) -> float:
        """Returns the moment of forces on ring and on output pins on the output at its angle, N m."""
        force = outer if self.layout.ring_turns else inner
        seats = self.offsets[self.layout.output_bodies] * np.exp(1j * angle)
        return float(np.sum(np.imag(np.conj(seats) * force)))

    def output_torque(self, states: Floats, loads: Floats) -> float:
        """Returns the moment on the output shaft without its load, N m.

        The contact forces of the pins that it carries, and its own moment: of sleeves that rub on their pins, and of a
        seal.
        """
        pins = self.layout.output_bodies
        x, y = states[pins, 0] - states[OUTPUT, 0], states[pins, 1] - states[OUTPUT, 1]
        return float(loads[OUTPUT, 2] + np.sum(x * loads[pins, 1] - y * loads[pins, 0]))


def turns(count: int) -> npt.NDArray[np.complex128]:
    """`count` points of the unit circle at equal steps, the first at angle 0."""
    return np.asarray(np.exp(2j * math.pi * np.arange(count) / count))


def _placed(gear: Gear, parts: str, radius_m: float, directions: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Centres of parts, m, that stand on a circle but for their errors: outwards, and counter-clockwise across it."""
    radial, tangential = (gear.errors(f"{parts}_{way}_m", directions.size) for way in ("radial", "tangential"))
    moved = (radius_m + radial.reshape(directions.shape)) + 1j * tangential.reshape(directions.shape)
    return np.asarray(moved * directions)


def wheel_phases(gear: Gear) -> Floats:
    """f of every disc at input angle 0, rad: discs stand evenly on the eccentric, but for their errors."""
    return _even_phases(gear) + gear.errors("phase_rad", gear.wheels)


def _even_phases(gear: Gear) -> Floats:
    return np.asarray(2.0 * math.pi * np.arange(gear.wheels) / gear.wheels)


def hole_centres(gear: Gear) -> npt.NDArray[np.complex128]:
    """Centres of the holes in each disc's frame, m, shape (discs, holes).

    At the start hole k is at the ground's angle 2 pi k/zi about its disc's centre, as output pin k is about the output's.
    The hole's own error is added to that.
    """
    start = (math.pi - _even_phases(gear)) / gear.lobes
    directions = turns(gear.internal_sleeves)[None, :] * np.exp(-1j * start)[:, None]
    return _placed(gear, "hole", gear.internal_circle_radius_m, directions)
