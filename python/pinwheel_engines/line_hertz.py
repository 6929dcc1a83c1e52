"""Rollers on a line: both bodies elastic, written a second time from the approach of each.

A pin of radius R_p and a disc that is h deep behind the contact are pressed together by F over the length L. The contact is
2 a wide, a^2 = 4 F R beta with B_i = (1 - nu_i^2)/(pi E_i L H), beta = B_p + B_d, R = R_c R_p/(R_c + R_p)   Hertz
    pin:  delta_p = B_p F (2 ln(4 R_p/a) - 1)                                              K. L. Johnson, 1985, 5.6
    disc: delta_d = B_d F (2 ln(2 h/a) - nu_d/(1 - nu_d))                                  C. Weber, K. Banaschek, 1953
    delta = delta_p + delta_d = beta F (c - ln F)
so c is what remains of the logarithms at F = 1 N. With w = c - ln F the slope dF/d delta is 1/(beta (w - 1)), and w - ln w
= c + ln(beta/delta), which the penetrations of gears put at 4 and more. Below 2.5 the approach would soon turn around: from
there on the contact is the spring that has the same force at that depth.

The energy U at a fixed penetration has dU/dR = beta F^2/(2 R): where R changes along the profile, there is a force along it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pinwheel_engines.geometry import Epitrochoid, Ints, root_between
from pinwheel_engines.layout import hole_centres
from pinwheel_engines.scene import Contact, Gear

Floats = npt.NDArray[np.float64]

# Least c + ln(beta/delta) at which the approach is followed.
LEAST_LEVEL = 2.5


@dataclass(frozen=True)
class LineHertz:
    """Law of one scene; contacts differ only in their radii."""

    pin_compliance: float
    """B_p, m/N."""
    disc_compliance: float
    """B_d, m/N."""
    disc_poisson: float
    disc_depth_m: float
    """h, m."""

    @staticmethod
    def of(contact: Contact, disc_depth_m: float) -> LineHertz:
        """The law of a scene's materials and length; H is a factor on both moduli."""
        over = 1.0 / (math.pi * contact.line_length_m * contact.stiffness_multiplier)
        pin = over * (1.0 - contact.pin_poisson**2) / contact.pin_young_pa
        disc = over * (1.0 - contact.poisson**2) / contact.young_pa
        return LineHertz(pin, disc, contact.poisson, disc_depth_m)

    @property
    def compliance(self) -> float:
        """beta, m/N."""
        return self.pin_compliance + self.disc_compliance

    def approach_m(self, force_n: Floats, radius_m: Floats, sleeve_m: Floats) -> Floats:
        """delta under a force, m, where the effective radius is R and the pin's own R_p: the sum of both bodies'."""
        a = np.sqrt(4.0 * force_n * radius_m * self.compliance)
        pin = self.pin_compliance * force_n * (2.0 * np.log(4.0 * sleeve_m / a) - 1.0)
        nu = self.disc_poisson
        disc = self.disc_compliance * force_n * (2.0 * np.log(2.0 * self.disc_depth_m / a) - nu / (1.0 - nu))
        return np.asarray(pin + disc)

    def force_and_slope(self, depth_m: Floats, radius_m: Floats, sleeve_m: Floats) -> tuple[Floats, Floats]:
        """F, N, and dF/d delta, N/m, at penetrations above 0."""
        beta = self.compliance
        c = self.approach_m(np.ones_like(radius_m), radius_m, sleeve_m) / beta
        deepest = beta * np.exp(c - LEAST_LEVEL)
        depth = np.minimum(depth_m, deepest)
        # w lies between the level l = w - ln w and 2 l, so F = delta/(beta w) between these forces.
        least = depth / (2.0 * beta * (c + np.log(beta / depth)))

        def excess(x: Floats, which: Ints) -> tuple[Floats, Floats]:
            # In shares of the least force, and in shares of the penetration.
            force = x * least[which]
            approach = self.approach_m(force, radius_m[which], sleeve_m[which])
            slope = approach / force - beta
            return approach / depth[which] - 1.0, slope * least[which] / depth[which]

        force = least * root_between(excess, np.ones_like(least), np.full_like(least, 2.0))
        slope = 1.0 / (beta * (depth / (beta * force) - 1.0))
        deep = depth_m > deepest
        return force * (depth_m / depth), np.where(deep, force / depth, slope)

    def along_n(self, force_n: Floats, radius_m: Floats, radius_slope: Floats) -> Floats:
        """-dU/dR dR/ds, N: the force on the pin's centre along s, by which R changes at the rate `radius_slope`."""
        return np.asarray(-0.5 * self.compliance * force_n**2 / radius_m * radius_slope)


def disc_depth_m(gear: Gear, contact: Contact) -> float:
    """h: the scene's, or the wall between a hole and the profile, at least half of a ring pin's radius, m."""
    if contact.disc_depth_m is not None:
        return contact.disc_depth_m
    return max(wall_m(gear), 0.5 * float(gear.external_sleeve_radius_m))


def wall_m(gear: Gear) -> float:
    """Least thickness of the wall between a hole and the disc's edge, m; negative where a hole leaves the disc.

    The edge is as far from a hole's centre as the curve, less q'; of a disc with turned flanks the nearer edge counts.
    """
    curve, centres = Epitrochoid.of(gear), hole_centres(gear)
    radii = (gear.hole_radius_m + gear.errors("hole_radius_m", centres.size)).ravel()
    walls = []
    for turn in (gear.rotational_rad, -gear.rotational_rad):
        p = centres.ravel() * np.exp(1j * turn)
        _, a = curve.inside(p)
        _, signed = curve.closest(p, a)
        walls.append(-signed - gear.edge_offset_m - radii)
    return float(np.min(walls))
