"""Checks that turn a silent blow-up into an error.

No engine here reports that its numbers ran away: MuJoCo resets its state, exudyn returns success with forces of 1e8 N.
The limits are physical, not tuned: a force that would press a pin into its counterpart by its own radius, and a
disc or output that left the mesh by one lobe, cannot belong to a working gearbox.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from pinwheel_engines.bed import hertz, nominal_penetration_m, nominal_rate_rad_s
from pinwheel_engines.errors import Diverged
from pinwheel_engines.layout import INPUT, OUTPUT, Kinematics
from pinwheel_engines.scene import Scene

Floats = npt.NDArray[np.float64]


class Guard:
    """Watches one run at its samples."""

    def __init__(self, engine: str, scene: Scene) -> None:
        self.engine = engine
        kinematics = Kinematics(scene.gear)
        self.wheels = kinematics.layout.wheel_bodies
        # All bodies turn at constant rates.
        self.ideal, self.ideal_rates = kinematics.ideal(scene)
        gear, law = scene.gear, hertz(scene)
        factor = max(law.stiffness_factor, law.hole_stiffness_factor)
        radius = max(gear.external_sleeve_radius_m, gear.internal_sleeve_radius_m)
        # Hertz with the pin's radius as the reduced radius, pressed in by one radius.
        self.force_limit_n = factor * math.sqrt(radius) * radius**1.5
        clearance = max(0.0, gear.hole_radius_m - gear.internal_sleeve_radius_m - gear.eccentricity_m)
        free_play = gear.backlash_m * math.sqrt(1.0 - gear.shortening**2) / (gear.eccentricity_m * gear.lobes)
        free_play += gear.extra_play_m / (gear.eccentricity_m * gear.lobes)
        clearance += gear.extra_play_m
        lobe = 2.0 * math.pi / gear.lobes
        self.wheel_limit_rad = lobe + free_play
        # The drivers used here hold the speed to 1e-9 and better; a thousandth of it, or of the speed of a disc that
        # swings by its nominal deformation, is no longer a driver.
        swing_rad_s = nominal_rate_rad_s(scene) * nominal_penetration_m(scene) / (gear.eccentricity_m * gear.lobes)
        self.slip_limit_rad_s = 1e-3 * max(abs(scene.drive.input_speed_rad_s), swing_rad_s)
        self.output_limit_rad = lobe + free_play + 2.0 * clearance / gear.internal_circle_radius_m

    def diverged(self, time_s: float, quantity: str) -> Diverged:
        """Makes the error of a divergence."""
        return Diverged(self.engine, time_s, quantity)

    def check_states(self, time_s: float, angles: Floats, rates: Floats) -> None:
        """Raises Diverged on a non-finite angle or rate, an input off its speed, a disc or output out of mesh."""
        for name, values in (("angle", angles), ("rate", rates)):
            finite = np.isfinite(values)
            if not finite.all():
                bad = int(np.argmin(finite))
                raise self.diverged(time_s, f"{name} of body {bad} is {values[bad]}")
        omega = self.ideal_rates[INPUT]
        slip = abs(rates[INPUT] - omega)
        if slip > self.slip_limit_rad_s:
            raise self.diverged(time_s, f"the input runs at {rates[INPUT]:.6g} rad/s instead of {omega:.6g}")
        apart = np.abs(angles - (self.ideal + self.ideal_rates * time_s))
        off = apart[self.wheels]
        if off.max() > self.wheel_limit_rad:
            i = int(np.argmax(off))
            raise self.diverged(time_s, f"disc {i} is {off[i]:.3g} rad away from the mesh, more than a lobe")
        if apart[OUTPUT] > self.output_limit_rad:
            raise self.diverged(time_s, f"the output shaft is {apart[OUTPUT]:.3g} rad away from the mesh")

    def check_forces(self, time_s: float, forces_n: Floats, what: str = "sleeve force") -> None:
        """Raises Diverged on a non-finite or impossible force."""
        size = np.abs(forces_n)
        good = size <= self.force_limit_n
        if not good.all():
            worst = float(size.flat[int(np.argmin(good))])
            raise self.diverged(
                time_s, f"{what} of {worst:.3g} N, above the {self.force_limit_n:.3g} N that press a pin in whole"
            )
