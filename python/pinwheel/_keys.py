"""Types of a scene's keys; written by `python/make_keys.py` from the program's table of keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

# Keys with integer values.
COUNTS = frozenset(
    {
        "bearings.eccentric.rollers",
        "contact.hole_points",
        "contact.wheel_points",
        "cranks.count",
        "cranks.planet_teeth",
        "cranks.sun_teeth",
        "gear.external_sleeves",
        "gear.internal_sleeves",
        "gear.wheels",
    }
)


class Keys(TypedDict, total=False):
    """Keys by their last part, and tables."""

    gear: Mapping[str, Any]
    mass: Mapping[str, Any]
    drive: Mapping[str, Any]
    contact: Mapping[str, Any]
    bearings: Mapping[str, Any]
    structure: Mapping[str, Any]
    temperature: Mapping[str, Any]
    cranks: Mapping[str, Any]
    limits: Mapping[str, Any]
    solver: Mapping[str, Any]
    output: Mapping[str, Any]
    base: str
    """preset or scene file from which everything is taken that is left out here"""
    bore_m: float
    """its bore d, for that moment (m)"""
    clearance_m: float
    """its radial clearance; absent: 0 (m)"""
    damping_n_s_m: float
    """C: damping of a contact (N s/m); if left out: 5 % of critical damping of the fastest mode under the largest static load; gear meshes have 3 to 17 %"""
    dynamic_rating_n: float
    """its basic dynamic rating C, for its life after ISO 281 (N)"""
    exponent: float
    """p of its force K d^p; absent: 1, or 10/9 of rollers"""
    friction_coefficient: float
    """mu; 0: no friction; if left out 0.0: no friction"""
    roller_diameter_m: float
    """diameter of these rollers, for its ratings after ISO 76 and ISO 281 (m)"""
    roller_length_m: float
    """length of these rollers (m)"""
    rollers: int
    """its rollers, where they give K after Palmgren"""
    stiffness_n_m: float
    """K of the bearing that carries a disc on its eccentric; or give rollers (N/m)"""
    input_seal_n_m: float
    """torque of the input shaft's seal against its turning; absent: 0 (N m)"""
    internal_sleeve_gap_m: float
    """gap between discs, and from the outer ones to what holds the output pins; absent: 0 (m)"""
    internal_sleeve_stiffness_n_m: float
    """stiffness of an output pin against bending, in series with its contacts; absent: rigid (N/m)"""
    internal_sleeves_held: Literal["one-end", "both-ends"]
    """ends at which the output pins are held, for their bending; absent: not judged"""
    output_seal_n_m: float
    """torque of the output shaft's seal against its turning; absent: 0 (N m)"""
    output_torsion_n_m_rad: float
    """torsional stiffness of carrier and flange; absent: rigid; counts in `design` alone (N m/rad)"""
    sleeve_bore_m: float
    """bore d of the pins, for that moment; thinner rollers turn in grooves, on their own diameter (m)"""
    sleeve_friction_coefficient: float
    """friction mu of a sleeve on its pin, of the moment mu F d/2 as it rolls; where that is more than the contact's own friction, the disc slides on the sleeve; absent: sleeves turn freely"""
    band_laws: str | Sequence[str]
    """laws that may be right for these rollers, whose spread is the band of a figure; absent: those for the materials; []: no band"""
    constant_stiffness_n_m15: float
    """K of laws with one stiffness for all contacts (N/m^1.5); if left out: after Hertz, of a ring pin on a flat; used by laws of one stiffness only"""
    detection: Literal["exact", "points"]
    """how the contact point is found; if left out 'exact': the closest point of the curve"""
    disc_depth_m: float
    """how deep a disc is behind a contact, of the law line-hertz; absent: the wall between a hole and the profile, at least half of the ring pins' radius (m)"""
    external_spring_n_m: float
    """k of external contacts under the law linear; absent: the secant of line-hertz under the largest load (N/m)"""
    friction_dynamic_coefficient: float
    """mu_d of the friction law adams; if left out 0.0: used by the friction law adams only"""
    friction_dynamic_speed_m_s: float
    """sliding speed from which mu_d holds (m/s); if left out: 20 times contact.friction_ramp_m_s; used by the friction law adams only"""
    friction_law: Literal["regularised", "adams"]
    """form of the friction; if left out 'regularised': Coulomb with a linear ramp"""
    friction_ramp_m_s: float
    """sliding speed at which friction reaches mu F_n (m/s); if left out: a thousandth of omega e"""
    hole_points: int
    """points on a hole; if left out 100: used by detection points only"""
    impact_speed_m_s: float
    """speed of an impact with that restitution (m/s); if left out 0.01: used by the hysteresis laws only"""
    internal_spring_n_m: float
    """k of internal contacts, likewise (N/m)"""
    internal_stiffness_multiplier: float
    """H of internal contacts, of laws of balls; absent: that of all"""
    law: Literal["paper", "paper-conservative", "constant", "hunt-crossley", "lee-wang", "herbert-mcwhannell", "lankarani-nikravesh", "flores", "adams-impact", "line-contact", "line-hertz", "lundberg", "kunert", "linear", "paper-printed"]
    """normal law; if left out 'line-hertz': rollers on a line, both bodies elastic; creates no energy"""
    line_length_m: float
    """length of a line contact (m); if left out: the face width, or 0.15 R; used by laws of rollers and for pressures"""
    material: Literal["steel", "cast-iron", "bronze", "aluminium", "pom", "nylon", "pla"]
    """material of the discs, for their limits and expansion; steel: hardened as rolling bearings are; absent: not known"""
    pin_material: Literal["steel", "cast-iron", "bronze", "aluminium", "pom", "nylon", "pla"]
    """material of the pins; absent: that of the discs"""
    pin_poisson: float
    """Poisson's ratio of the pins; absent: that of the discs"""
    pin_young_pa: float
    """E of the pins; absent: that of the discs (Pa)"""
    poisson: float
    """Poisson's ratio of the discs; if left out 0.3: steel"""
    ramp_m: float
    """penetration at which S reaches 1 (m); if left out: a tenth of the penetration under the largest static load"""
    restitution: float
    """c of the hysteresis laws; if left out 0.9: used by the hysteresis laws only"""
    stiffness_multiplier: float
    """H: factor on the stiffness after Hertz; if left out 1.0: the full stiffness after Hertz"""
    wheel_points: int
    """points on a disc's profile; if left out: 100 a lobe, at least 4000; used by detection points only"""
    young_pa: float
    """E of the discs (Pa); if left out 2.1e11: steel"""
    bore_radius_m: float
    """a disc's bore for a crank's eccentric and its bearing (m)"""
    circle_radius_m: float
    """circle the cranks stand on (m)"""
    count: int
    """cranks of an RV reducer, which carry the discs in the place of one eccentric"""
    mesh_stiffness_n_m: float
    """stiffness of the mesh of the sun with a planet along the line of action, without mass; absent: rigid (N/m)"""
    planet_teeth: int
    """teeth of a planet, one on each crank"""
    sun_teeth: int
    """teeth of the sun on the input shaft"""
    support_stiffness_n_m: float
    """stiffness of what holds a crank in the output; absent: rigid (N/m)"""
    description: str
    """why this scene exists, one sentence"""
    input_speed_rad_s: float
    """omega (rad/s)"""
    load_changes: Sequence[Mapping[str, Any]]
    """what the load becomes during the run"""
    load_ramp_s: float
    """the load rises linearly over this time; 0: at once (s); if left out 0.0: the load acts at once"""
    output_torque_n_m: float
    """load on the output shaft, counter-clockwise; positive opposes the motion of a positive input speed, of an RV gear that of a negative one, and of a ring the other way round (N m)"""
    speed_changes: Sequence[Mapping[str, Any]]
    """what the speed of the input becomes during the run"""
    start: Literal["kinematic", "equilibrium"]
    """state at t = 0; if left out 'kinematic': rates of the ideal mesh, load at once"""
    backlash_m: float
    """d: ring pins sit at R + d (m); if left out 0.0: no backlash"""
    eccentric_bore_radius_m: float
    """a disc's bore for the bearing on its eccentric; absent: 0.6 (internal circle - hole radius) (m)"""
    eccentricity_m: float
    """e (m)"""
    crank_phase_rad: Sequence[float] | npt.NDArray[np.float64]
    """of each crank of an RV gear, how far it stands counter-clockwise of its place (rad)"""
    external_sleeve_radial_m: Sequence[float] | npt.NDArray[np.float64]
    """of each ring pin, how far it sits outwards of its place (m)"""
    external_sleeve_radius_m: float
    """q: radius of a ring pin (m)"""
    external_sleeve_tangential_m: Sequence[float] | npt.NDArray[np.float64]
    """of each ring pin, how far it sits counter-clockwise of its place (m)"""
    hole_radial_m: Sequence[float] | npt.NDArray[np.float64]
    """of each hole, disc by disc, how far it sits outwards of its place (m)"""
    hole_radius_m: float
    """radius of a disc's hole (m); if left out: gear.internal_sleeve_radius_m + gear.eccentricity_m: a hole without clearance"""
    hole_tangential_m: Sequence[float] | npt.NDArray[np.float64]
    """of each hole, disc by disc, how far it sits counter-clockwise of its place (m)"""
    internal_sleeve_radial_m: Sequence[float] | npt.NDArray[np.float64]
    """of each output pin, how far it sits outwards of its place (m)"""
    internal_sleeve_radius_m: float
    """radius of an output pin (m); if left out: cranks.bore_radius_m - gear.eccentricity_m: a crank's shaft just passes its bore"""
    internal_sleeve_tangential_m: Sequence[float] | npt.NDArray[np.float64]
    """of each output pin, how far it sits counter-clockwise of its place (m)"""
    phase_rad: Sequence[float] | npt.NDArray[np.float64]
    """of each disc, how far its eccentric stands counter-clockwise of its place (rad)"""
    external_sleeves: int
    """zk: pins on the housing; a disc has one lobe less"""
    external_sleeves_turn: bool
    """ring pins are sleeves that turn; false: the disc slides on pins that stand still; absent: true"""
    face_width_m: float
    """thickness of a disc; for masses that are left out (m)"""
    internal_circle_radius_m: float
    """circle the output pins sit on (m); if left out: cranks.circle_radius_m"""
    internal_sleeves: int
    """zi: pins on the output shaft; if left out: cranks.count: cranks stand in the place of output pins"""
    internal_sleeves_turn: bool
    """output pins are sleeves that turn; false: they turn with the output alone; absent: true"""
    equidistant_m: float
    """the generating pin's radius is larger than q by this: above 0 the disc's whole edge lies that much further in (m)"""
    cos_m: Sequence[float] | npt.NDArray[np.float64]
    """own profile as a Fourier series of a lobe's phase, 0 at its tip: amplitudes of cosines from order 0 on (m)"""
    points_m: Sequence[float] | npt.NDArray[np.float64]
    """own profile: offset of the generating curve along its inward normal at equal steps over a lobe from its tip on, all lobes alike; a periodic cubic spline (m)"""
    sin_m: Sequence[float] | npt.NDArray[np.float64]
    """the series' amplitudes of sines from order 1 on (m)"""
    radial_m: float
    """the generating circle is larger than R by this: below 0 the disc is smaller (m)"""
    rotational_rad: float
    """both flanks of a lobe are turned towards its middle by this (rad)"""
    pin_circle_radius_m: float
    """R: circle of the ring pins without backlash; instead of gear.shortening (m)"""
    shortening: float
    """m: shortening coefficient e zk/R; if left out: e zk/R with R = gear.pin_circle_radius_m"""
    wheels: int
    """discs, evenly phased on the eccentric"""
    bending_pa: float
    """largest bending stress of an output pin; absent: the yield strength of its material (Pa)"""
    life_h: float
    """least basic rating life of that bearing; absent: not judged (h)"""
    pressure_pa: float
    """largest pressure p0 of a contact; absent: that of the material (Pa)"""
    pressure_sliding_w_m2: float
    """largest pressure on the projected area times sliding speed (pv) of a sleeve; absent: that of the material (W/m^2)"""
    static_safety: float
    """least static safety of the bearing that carries a disc; absent: 1"""
    wall_m: float
    """least wall of a disc between holes, edge and bore; absent: by the shear stress there (m)"""
    density_kg_m3: float
    """density of all bodies; for masses that are left out (kg/m^3)"""
    name: str
    """name shown in reports; the file's if left out"""
    channels: str | Sequence[str]
    """columns beyond those every run has; `*` stands for any characters"""
    duration_s: float
    """end time (s); if left out: until the start-up has died away and two turns of the input more; 3 to 10 turns"""
    formulation: Literal["reduced", "lagrange"]
    """which equations are integrated; if left out 'reduced': centre-pinned bodies eliminated exactly"""
    integrator: Literal["auto", "rk2", "rk4", "dopri5", "dop853", "etd-adams", "imex2", "imex2-adaptive", "rodas5p"]
    """name of the integrator; if left out 'auto': the method that the scene's forces ask for"""
    sample_s: float
    """samples stand this far apart (s); if left out: 40 a mesh period and 4 a period of the fastest mode, at most 20000 in all"""
    stabilisation: Literal["projection", "baumgarte", "none"]
    """how the Lagrange form keeps its constraints; if left out 'projection': of the Lagrange form"""
    step_s: float
    """step of fixed-step methods (s); if left out: about 50 a period of the fastest mode under the largest static load"""
    tolerance: float
    """relative error a step of adaptive methods; if left out 1e-6: relative error a step of adaptive methods"""
    housing_material: Literal["steel", "cast-iron", "bronze", "aluminium", "pom", "nylon", "pla"]
    """material of the housing, for seats and expansion; absent: that of the pins"""
    input_torsion_n_m_rad: float
    """torsional stiffness of the input shaft, which counts at the output times the ratio squared; absent: rigid; counts in `design` alone (N m/rad)"""
    output_pin_diameter_m: float
    """diameter of the output pins as beams that all discs bend together, held as bearings.internal_sleeves_held says; disc 0 is nearest to the flange; absent: rigid (m)"""
    output_seat_length_m: float
    """length of an output pin's seat, a line contact in series with its bending; absent: rigid (m)"""
    plate_radius_m: float
    """radius at which the flange takes the torque from that plate (m)"""
    plate_thickness_m: float
    """thickness of the plate between output pins and flange, in torsion; absent: rigid; counts in `design` alone (m)"""
    ring_seat_length_m: float
    """length of a ring pin's seat in the housing, a line contact in series with its contacts; absent: rigid (m)"""
    ring_slot_clearance_m: float
    """radial clearance of ring pins in slots, taken up along the normal of the contact; absent: 0 (m)"""
    disc_k: float
    """discs, eccentrics and carrier, likewise; absent: 0 (K)"""
    housing_k: float
    """housing with the ring, by how much warmer than when its sizes were measured; absent: 0 (K)"""
    pins_k: float
    """ring pins and output pins, likewise; absent: 0 (K)"""


Axis: TypeAlias = Sequence[Any] | Mapping[str, Any] | Any
# Keys that vary, by their last part or in full.
Vary = TypedDict(
    "Vary",
    {
        "base": Axis,
        "bore_m": Axis,
        "clearance_m": Axis,
        "damping_n_s_m": Axis,
        "dynamic_rating_n": Axis,
        "exponent": Axis,
        "friction_coefficient": Axis,
        "roller_diameter_m": Axis,
        "roller_length_m": Axis,
        "rollers": Axis,
        "stiffness_n_m": Axis,
        "input_seal_n_m": Axis,
        "internal_sleeve_gap_m": Axis,
        "internal_sleeve_stiffness_n_m": Axis,
        "internal_sleeves_held": Axis,
        "output_seal_n_m": Axis,
        "output_torsion_n_m_rad": Axis,
        "sleeve_bore_m": Axis,
        "sleeve_friction_coefficient": Axis,
        "band_laws": Axis,
        "constant_stiffness_n_m15": Axis,
        "detection": Axis,
        "disc_depth_m": Axis,
        "external_spring_n_m": Axis,
        "friction_dynamic_coefficient": Axis,
        "friction_dynamic_speed_m_s": Axis,
        "friction_law": Axis,
        "friction_ramp_m_s": Axis,
        "hole_points": Axis,
        "impact_speed_m_s": Axis,
        "internal_spring_n_m": Axis,
        "internal_stiffness_multiplier": Axis,
        "law": Axis,
        "line_length_m": Axis,
        "material": Axis,
        "pin_material": Axis,
        "pin_poisson": Axis,
        "pin_young_pa": Axis,
        "poisson": Axis,
        "ramp_m": Axis,
        "restitution": Axis,
        "stiffness_multiplier": Axis,
        "wheel_points": Axis,
        "young_pa": Axis,
        "bore_radius_m": Axis,
        "circle_radius_m": Axis,
        "count": Axis,
        "mesh_stiffness_n_m": Axis,
        "planet_teeth": Axis,
        "sun_teeth": Axis,
        "support_stiffness_n_m": Axis,
        "description": Axis,
        "input_speed_rad_s": Axis,
        "load_changes": Axis,
        "load_ramp_s": Axis,
        "output_torque_n_m": Axis,
        "speed_changes": Axis,
        "start": Axis,
        "backlash_m": Axis,
        "eccentric_bore_radius_m": Axis,
        "eccentricity_m": Axis,
        "crank_phase_rad": Axis,
        "external_sleeve_radial_m": Axis,
        "external_sleeve_radius_m": Axis,
        "external_sleeve_tangential_m": Axis,
        "hole_radial_m": Axis,
        "hole_radius_m": Axis,
        "hole_tangential_m": Axis,
        "internal_sleeve_radial_m": Axis,
        "internal_sleeve_radius_m": Axis,
        "internal_sleeve_tangential_m": Axis,
        "phase_rad": Axis,
        "external_sleeves": Axis,
        "external_sleeves_turn": Axis,
        "face_width_m": Axis,
        "internal_circle_radius_m": Axis,
        "internal_sleeves": Axis,
        "internal_sleeves_turn": Axis,
        "equidistant_m": Axis,
        "cos_m": Axis,
        "points_m": Axis,
        "sin_m": Axis,
        "radial_m": Axis,
        "rotational_rad": Axis,
        "pin_circle_radius_m": Axis,
        "shortening": Axis,
        "wheels": Axis,
        "bending_pa": Axis,
        "life_h": Axis,
        "pressure_pa": Axis,
        "pressure_sliding_w_m2": Axis,
        "static_safety": Axis,
        "wall_m": Axis,
        "density_kg_m3": Axis,
        "name": Axis,
        "channels": Axis,
        "duration_s": Axis,
        "formulation": Axis,
        "integrator": Axis,
        "sample_s": Axis,
        "stabilisation": Axis,
        "step_s": Axis,
        "tolerance": Axis,
        "housing_material": Axis,
        "input_torsion_n_m_rad": Axis,
        "output_pin_diameter_m": Axis,
        "output_seat_length_m": Axis,
        "plate_radius_m": Axis,
        "plate_thickness_m": Axis,
        "ring_seat_length_m": Axis,
        "ring_slot_clearance_m": Axis,
        "disc_k": Axis,
        "housing_k": Axis,
        "pins_k": Axis,
        "bearings.eccentric.bore_m": Axis,
        "bearings.eccentric.clearance_m": Axis,
        "bearings.eccentric.damping_n_s_m": Axis,
        "bearings.eccentric.dynamic_rating_n": Axis,
        "bearings.eccentric.exponent": Axis,
        "bearings.eccentric.friction_coefficient": Axis,
        "bearings.eccentric.roller_diameter_m": Axis,
        "bearings.eccentric.roller_length_m": Axis,
        "bearings.eccentric.rollers": Axis,
        "bearings.eccentric.stiffness_n_m": Axis,
        "bearings.input_seal_n_m": Axis,
        "bearings.internal_sleeve_gap_m": Axis,
        "bearings.internal_sleeve_stiffness_n_m": Axis,
        "bearings.internal_sleeves_held": Axis,
        "bearings.output_seal_n_m": Axis,
        "bearings.output_torsion_n_m_rad": Axis,
        "bearings.sleeve_bore_m": Axis,
        "bearings.sleeve_friction_coefficient": Axis,
        "contact.band_laws": Axis,
        "contact.constant_stiffness_n_m15": Axis,
        "contact.damping_n_s_m": Axis,
        "contact.detection": Axis,
        "contact.disc_depth_m": Axis,
        "contact.external_spring_n_m": Axis,
        "contact.friction_coefficient": Axis,
        "contact.friction_dynamic_coefficient": Axis,
        "contact.friction_dynamic_speed_m_s": Axis,
        "contact.friction_law": Axis,
        "contact.friction_ramp_m_s": Axis,
        "contact.hole_points": Axis,
        "contact.impact_speed_m_s": Axis,
        "contact.internal_spring_n_m": Axis,
        "contact.internal_stiffness_multiplier": Axis,
        "contact.law": Axis,
        "contact.line_length_m": Axis,
        "contact.material": Axis,
        "contact.pin_material": Axis,
        "contact.pin_poisson": Axis,
        "contact.pin_young_pa": Axis,
        "contact.poisson": Axis,
        "contact.ramp_m": Axis,
        "contact.restitution": Axis,
        "contact.stiffness_multiplier": Axis,
        "contact.wheel_points": Axis,
        "contact.young_pa": Axis,
        "cranks.bore_radius_m": Axis,
        "cranks.circle_radius_m": Axis,
        "cranks.count": Axis,
        "cranks.mesh_stiffness_n_m": Axis,
        "cranks.planet_teeth": Axis,
        "cranks.sun_teeth": Axis,
        "cranks.support_stiffness_n_m": Axis,
        "drive.input_speed_rad_s": Axis,
        "drive.load_changes": Axis,
        "drive.load_ramp_s": Axis,
        "drive.output": Axis,
        "drive.output_torque_n_m": Axis,
        "drive.speed_changes": Axis,
        "drive.start": Axis,
        "gear.backlash_m": Axis,
        "gear.eccentric_bore_radius_m": Axis,
        "gear.eccentricity_m": Axis,
        "gear.errors.crank_phase_rad": Axis,
        "gear.errors.eccentricity_m": Axis,
        "gear.errors.external_sleeve_radial_m": Axis,
        "gear.errors.external_sleeve_radius_m": Axis,
        "gear.errors.external_sleeve_tangential_m": Axis,
        "gear.errors.hole_radial_m": Axis,
        "gear.errors.hole_radius_m": Axis,
        "gear.errors.hole_tangential_m": Axis,
        "gear.errors.internal_sleeve_radial_m": Axis,
        "gear.errors.internal_sleeve_radius_m": Axis,
        "gear.errors.internal_sleeve_tangential_m": Axis,
        "gear.errors.phase_rad": Axis,
        "gear.external_sleeve_radius_m": Axis,
        "gear.external_sleeves": Axis,
        "gear.external_sleeves_turn": Axis,
        "gear.face_width_m": Axis,
        "gear.hole_radius_m": Axis,
        "gear.internal_circle_radius_m": Axis,
        "gear.internal_sleeve_radius_m": Axis,
        "gear.internal_sleeves": Axis,
        "gear.internal_sleeves_turn": Axis,
        "gear.modification.equidistant_m": Axis,
        "gear.modification.normal_m.cos_m": Axis,
        "gear.modification.normal_m.points_m": Axis,
        "gear.modification.normal_m.sin_m": Axis,
        "gear.modification.radial_m": Axis,
        "gear.modification.rotational_rad": Axis,
        "gear.pin_circle_radius_m": Axis,
        "gear.shortening": Axis,
        "gear.wheels": Axis,
        "limits.bending_pa": Axis,
        "limits.life_h": Axis,
        "limits.pressure_pa": Axis,
        "limits.pressure_sliding_w_m2": Axis,
        "limits.static_safety": Axis,
        "limits.wall_m": Axis,
        "mass.density_kg_m3": Axis,
        "mass.external_sleeve.mass_kg": Axis,
        "mass.external_sleeve.moment_kg_m2": Axis,
        "mass.input_shaft.mass_kg": Axis,
        "mass.input_shaft.moment_kg_m2": Axis,
        "mass.internal_sleeve.mass_kg": Axis,
        "mass.internal_sleeve.moment_kg_m2": Axis,
        "mass.output_shaft.mass_kg": Axis,
        "mass.output_shaft.moment_kg_m2": Axis,
        "mass.wheel.mass_kg": Axis,
        "mass.wheel.moment_kg_m2": Axis,
        "output.channels": Axis,
        "solver.duration_s": Axis,
        "solver.formulation": Axis,
        "solver.integrator": Axis,
        "solver.sample_s": Axis,
        "solver.stabilisation": Axis,
        "solver.step_s": Axis,
        "solver.tolerance": Axis,
        "structure.housing_material": Axis,
        "structure.input_torsion_n_m_rad": Axis,
        "structure.output_pin_diameter_m": Axis,
        "structure.output_seat_length_m": Axis,
        "structure.plate_radius_m": Axis,
        "structure.plate_thickness_m": Axis,
        "structure.ring_seat_length_m": Axis,
        "structure.ring_slot_clearance_m": Axis,
        "temperature.disc_k": Axis,
        "temperature.housing_k": Axis,
        "temperature.pins_k": Axis,
    },
    total=False,
)

# Columns of a run, and channels; of 40 ring and 16 output pins and 3 discs.
Column: TypeAlias = Literal[
    "time_s",
    "input_torque_n_m",
    "output_torque_n_m",
    "output_angle_rad",
    "external_sleeve_force_n",
    "internal_sleeve_force_n",
    "efficiency",
    "input_power_w",
    "output_power_w",
    "damping_loss_w",
    "friction_loss_w",
    "transmission_error_arcmin",
    "wheel_transmission_error_arcmin",
    "external_contact_ratio",
    "internal_contact_ratio",
    "input_bearing_force_n",
    "input_bearing_force_x_n",
    "input_bearing_force_y_n",
    "output_bearing_force_n",
    "output_bearing_force_x_n",
    "output_bearing_force_y_n",
    "eccentric_bearing_force_n",
    "eccentric_bearing_force_x_n",
    "eccentric_bearing_force_y_n",
    "eccentric_bearing_radial_force_n",
    "eccentric_bearing_tangential_force_n",
    "eccentric_bearing_offset_x_m",
    "eccentric_bearing_offset_y_m",
    "external_pin_force_n",
    "external_pin_force_x_n",
    "external_pin_force_y_n",
    "internal_pin_force_n",
    "internal_pin_force_x_n",
    "internal_pin_force_y_n",
    "wheel_0_external_penetration_m",
    "wheel_1_external_penetration_m",
    "wheel_2_external_penetration_m",
    "wheel_0_external_normal_velocity_m_s",
    "wheel_1_external_normal_velocity_m_s",
    "wheel_2_external_normal_velocity_m_s",
    "wheel_0_external_tangential_velocity_m_s",
    "wheel_1_external_tangential_velocity_m_s",
    "wheel_2_external_tangential_velocity_m_s",
    "wheel_0_external_stiffness_n_m15",
    "wheel_1_external_stiffness_n_m15",
    "wheel_2_external_stiffness_n_m15",
    "wheel_0_external_contact_x_m",
    "wheel_1_external_contact_x_m",
    "wheel_2_external_contact_x_m",
    "wheel_0_external_contact_y_m",
    "wheel_1_external_contact_y_m",
    "wheel_2_external_contact_y_m",
    "wheel_0_external_normal_force_n",
    "wheel_1_external_normal_force_n",
    "wheel_2_external_normal_force_n",
    "wheel_0_external_friction_force_n",
    "wheel_1_external_friction_force_n",
    "wheel_2_external_friction_force_n",
    "wheel_0_external_force_x_n",
    "wheel_1_external_force_x_n",
    "wheel_2_external_force_x_n",
    "wheel_0_external_force_y_n",
    "wheel_1_external_force_y_n",
    "wheel_2_external_force_y_n",
    "wheel_0_external_pressure_pa",
    "wheel_1_external_pressure_pa",
    "wheel_2_external_pressure_pa",
    "wheel_0_external_pressure_sliding_w_m2",
    "wheel_1_external_pressure_sliding_w_m2",
    "wheel_2_external_pressure_sliding_w_m2",
    "wheel_0_internal_penetration_m",
    "wheel_1_internal_penetration_m",
    "wheel_2_internal_penetration_m",
    "wheel_0_internal_normal_velocity_m_s",
    "wheel_1_internal_normal_velocity_m_s",
    "wheel_2_internal_normal_velocity_m_s",
    "wheel_0_internal_tangential_velocity_m_s",
    "wheel_1_internal_tangential_velocity_m_s",
    "wheel_2_internal_tangential_velocity_m_s",
    "wheel_0_internal_stiffness_n_m15",
    "wheel_1_internal_stiffness_n_m15",
    "wheel_2_internal_stiffness_n_m15",
    "wheel_0_internal_contact_x_m",
    "wheel_1_internal_contact_x_m",
    "wheel_2_internal_contact_x_m",
    "wheel_0_internal_contact_y_m",
    "wheel_1_internal_contact_y_m",
    "wheel_2_internal_contact_y_m",
    "wheel_0_internal_normal_force_n",
    "wheel_1_internal_normal_force_n",
    "wheel_2_internal_normal_force_n",
    "wheel_0_internal_friction_force_n",
    "wheel_1_internal_friction_force_n",
    "wheel_2_internal_friction_force_n",
    "wheel_0_internal_force_x_n",
    "wheel_1_internal_force_x_n",
    "wheel_2_internal_force_x_n",
    "wheel_0_internal_force_y_n",
    "wheel_1_internal_force_y_n",
    "wheel_2_internal_force_y_n",
    "wheel_0_internal_pressure_pa",
    "wheel_1_internal_pressure_pa",
    "wheel_2_internal_pressure_pa",
    "wheel_0_internal_pressure_sliding_w_m2",
    "wheel_1_internal_pressure_sliding_w_m2",
    "wheel_2_internal_pressure_sliding_w_m2",
    "output_rate_rad_s",
    "wheel_angle_rad",
    "wheel_rate_rad_s",
    "wheel_x_m",
    "wheel_y_m",
    "wheel_velocity_x_m_s",
    "wheel_velocity_y_m_s",
    "external_sleeve_rate_rad_s",
    "internal_sleeve_rate_rad_s",
    "external_sleeve_force_n_0",
    "external_sleeve_force_n_1",
    "external_sleeve_force_n_2",
    "external_sleeve_force_n_3",
    "external_sleeve_force_n_4",
    "external_sleeve_force_n_5",
    "external_sleeve_force_n_6",
    "external_sleeve_force_n_7",
    "external_sleeve_force_n_8",
    "external_sleeve_force_n_9",
    "external_sleeve_force_n_10",
    "external_sleeve_force_n_11",
    "external_sleeve_force_n_12",
    "external_sleeve_force_n_13",
    "external_sleeve_force_n_14",
    "external_sleeve_force_n_15",
    "external_sleeve_force_n_16",
    "external_sleeve_force_n_17",
    "external_sleeve_force_n_18",
    "external_sleeve_force_n_19",
    "external_sleeve_force_n_20",
    "external_sleeve_force_n_21",
    "external_sleeve_force_n_22",
    "external_sleeve_force_n_23",
    "external_sleeve_force_n_24",
    "external_sleeve_force_n_25",
    "external_sleeve_force_n_26",
    "external_sleeve_force_n_27",
    "external_sleeve_force_n_28",
    "external_sleeve_force_n_29",
    "external_sleeve_force_n_30",
    "external_sleeve_force_n_31",
    "external_sleeve_force_n_32",
    "external_sleeve_force_n_33",
    "external_sleeve_force_n_34",
    "external_sleeve_force_n_35",
    "external_sleeve_force_n_36",
    "external_sleeve_force_n_37",
    "external_sleeve_force_n_38",
    "external_sleeve_force_n_39",
    "internal_sleeve_force_n_0",
    "internal_sleeve_force_n_1",
    "internal_sleeve_force_n_2",
    "internal_sleeve_force_n_3",
    "internal_sleeve_force_n_4",
    "internal_sleeve_force_n_5",
    "internal_sleeve_force_n_6",
    "internal_sleeve_force_n_7",
    "internal_sleeve_force_n_8",
    "internal_sleeve_force_n_9",
    "internal_sleeve_force_n_10",
    "internal_sleeve_force_n_11",
    "internal_sleeve_force_n_12",
    "internal_sleeve_force_n_13",
    "internal_sleeve_force_n_14",
    "internal_sleeve_force_n_15",
    "wheel_transmission_error_arcmin_0",
    "wheel_transmission_error_arcmin_1",
    "wheel_transmission_error_arcmin_2",
    "external_contact_ratio_0",
    "external_contact_ratio_1",
    "external_contact_ratio_2",
    "internal_contact_ratio_0",
    "internal_contact_ratio_1",
    "internal_contact_ratio_2",
    "eccentric_bearing_force_n_0",
    "eccentric_bearing_force_n_1",
    "eccentric_bearing_force_n_2",
    "eccentric_bearing_force_x_n_0",
    "eccentric_bearing_force_x_n_1",
    "eccentric_bearing_force_x_n_2",
    "eccentric_bearing_force_y_n_0",
    "eccentric_bearing_force_y_n_1",
    "eccentric_bearing_force_y_n_2",
    "eccentric_bearing_radial_force_n_0",
    "eccentric_bearing_radial_force_n_1",
    "eccentric_bearing_radial_force_n_2",
    "eccentric_bearing_tangential_force_n_0",
    "eccentric_bearing_tangential_force_n_1",
    "eccentric_bearing_tangential_force_n_2",
    "eccentric_bearing_offset_x_m_0",
    "eccentric_bearing_offset_x_m_1",
    "eccentric_bearing_offset_x_m_2",
    "eccentric_bearing_offset_y_m_0",
    "eccentric_bearing_offset_y_m_1",
    "eccentric_bearing_offset_y_m_2",
    "wheel_angle_rad_0",
    "wheel_angle_rad_1",
    "wheel_angle_rad_2",
    "wheel_rate_rad_s_0",
    "wheel_rate_rad_s_1",
    "wheel_rate_rad_s_2",
    "wheel_x_m_0",
    "wheel_x_m_1",
    "wheel_x_m_2",
    "wheel_y_m_0",
    "wheel_y_m_1",
    "wheel_y_m_2",
    "wheel_velocity_x_m_s_0",
    "wheel_velocity_x_m_s_1",
    "wheel_velocity_x_m_s_2",
    "wheel_velocity_y_m_s_0",
    "wheel_velocity_y_m_s_1",
    "wheel_velocity_y_m_s_2",
    "external_sleeve_rate_rad_s_0",
    "external_sleeve_rate_rad_s_1",
    "external_sleeve_rate_rad_s_2",
    "external_sleeve_rate_rad_s_3",
    "external_sleeve_rate_rad_s_4",
    "external_sleeve_rate_rad_s_5",
    "external_sleeve_rate_rad_s_6",
    "external_sleeve_rate_rad_s_7",
    "external_sleeve_rate_rad_s_8",
    "external_sleeve_rate_rad_s_9",
    "external_sleeve_rate_rad_s_10",
    "external_sleeve_rate_rad_s_11",
    "external_sleeve_rate_rad_s_12",
    "external_sleeve_rate_rad_s_13",
    "external_sleeve_rate_rad_s_14",
    "external_sleeve_rate_rad_s_15",
    "external_sleeve_rate_rad_s_16",
    "external_sleeve_rate_rad_s_17",
    "external_sleeve_rate_rad_s_18",
    "external_sleeve_rate_rad_s_19",
    "external_sleeve_rate_rad_s_20",
    "external_sleeve_rate_rad_s_21",
    "external_sleeve_rate_rad_s_22",
    "external_sleeve_rate_rad_s_23",
    "external_sleeve_rate_rad_s_24",
    "external_sleeve_rate_rad_s_25",
    "external_sleeve_rate_rad_s_26",
    "external_sleeve_rate_rad_s_27",
    "external_sleeve_rate_rad_s_28",
    "external_sleeve_rate_rad_s_29",
    "external_sleeve_rate_rad_s_30",
    "external_sleeve_rate_rad_s_31",
    "external_sleeve_rate_rad_s_32",
    "external_sleeve_rate_rad_s_33",
    "external_sleeve_rate_rad_s_34",
    "external_sleeve_rate_rad_s_35",
    "external_sleeve_rate_rad_s_36",
    "external_sleeve_rate_rad_s_37",
    "external_sleeve_rate_rad_s_38",
    "external_sleeve_rate_rad_s_39",
    "internal_sleeve_rate_rad_s_0",
    "internal_sleeve_rate_rad_s_1",
    "internal_sleeve_rate_rad_s_2",
    "internal_sleeve_rate_rad_s_3",
    "internal_sleeve_rate_rad_s_4",
    "internal_sleeve_rate_rad_s_5",
    "internal_sleeve_rate_rad_s_6",
    "internal_sleeve_rate_rad_s_7",
    "internal_sleeve_rate_rad_s_8",
    "internal_sleeve_rate_rad_s_9",
    "internal_sleeve_rate_rad_s_10",
    "internal_sleeve_rate_rad_s_11",
    "internal_sleeve_rate_rad_s_12",
    "internal_sleeve_rate_rad_s_13",
    "internal_sleeve_rate_rad_s_14",
    "internal_sleeve_rate_rad_s_15",
]
