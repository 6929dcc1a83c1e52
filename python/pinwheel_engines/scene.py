"""The scene: everything a run depends on, as the TOML file names it.

The file is complete and checked: the Pinwheel program resolves what a scene leaves to its base and checks every value. So
nothing here has a default. A key is an attribute of its table, under the file's own name; only what is computed from keys
is written out. A key that an engine asks for and the file lacks is an error that names it, other keys are left alone.
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import SceneError

# Tolerance of equal times, s: more than their rounding.
APART_S = 1e-9


@dataclass(frozen=True)
class Table:
    """A table of the file; its keys are read-only attributes, tables within it are tables."""

    _keys: dict[str, Any]
    _where: str
    """Name of the table with a dot at its end, for messages."""

    def __getattr__(self, key: str) -> Any:
        if key.startswith("__"):  # Python asks for these of any object, as in a copy
            raise AttributeError(key)
        if key not in self._keys:
            raise SceneError(
                f"key `{self._where}{key}` is missing; these engines take complete scenes, like reference/scenes/paper.toml"
            )
        value = self._keys[key]
        return Table(value, f"{self._where}{key}.") if isinstance(value, dict) else value


@dataclass(frozen=True)
class Gear(Table):
    """Geometry (Tab. 1 and Fig. 3 of the paper)."""

    @property
    def sleeves_turn(self) -> tuple[bool, bool]:
        """True for ring and for output pins that are sleeves that turn."""
        return bool(self._keys.get("external_sleeves_turn", True)), bool(self._keys.get("internal_sleeves_turn", True))

    @property
    def lobes(self) -> int:
        """zs, lobes of a disc."""
        return int(self.external_sleeves) - 1

    @property
    def eccentric_per_input(self) -> float:
        """Ratio of the eccentrics' angle to the input's at the ideal mesh: 1 except in RV gears."""
        return float(self._keys.get("eccentric_per_input", 1.0))

    @property
    def ring_turns(self) -> bool:
        """True if the ring is the output, and the carrier of the output pins is held."""
        return bool(self._keys.get("ring_turns", False))

    @property
    def pitch_radius_m(self) -> float:
        """R = e zk/m: radius of the circle the ring pins sit on without backlash."""
        return float(self.eccentricity_m * self.external_sleeves / self.shortening)

    def _modification(self, key: str) -> float:
        return float(self._keys.get("modification", {}).get(key, 0.0))

    @property
    def generating_radius_m(self) -> float:
        """R' = R + radial modification: the circle on which the pin runs that makes the discs' edge."""
        return self.pitch_radius_m + self._modification("radial_m")

    @property
    def generating_shortening(self) -> float:
        """m' = e zk/R'."""
        if self.generating_radius_m == self.pitch_radius_m:
            return float(self.shortening)
        return float(self.eccentricity_m * self.external_sleeves / self.generating_radius_m)

    @property
    def edge_offset_m(self) -> float:
        """q' = q + equidistant modification: the radius of that pin."""
        return float(self.external_sleeve_radius_m) + self._modification("equidistant_m")

    @property
    def rotational_rad(self) -> float:
        """Angle by which both flanks of a lobe are turned towards its middle."""
        return self._modification("rotational_rad")

    @property
    def normal_m(self) -> dict[str, list[float]]:
        """Lists of an offset of the generating curve along its inward normal; empty: none."""
        lists = self._keys.get("modification", {}).get("normal_m", {})
        return {key: values for key, values in lists.items() if values}

    @property
    def has_errors(self) -> bool:
        """True if a single pin, hole or disc deviates."""
        return any(self._keys.get("errors", {}).values())

    def errors(self, key: str, count: int) -> npt.NDArray[np.float64]:
        """Errors of a name, one for each of `count` parts; zeros if the scene has none."""
        values = self._keys.get("errors", {}).get(key) or np.zeros(count)
        return np.asarray(values, dtype=np.float64)

    @property
    def extra_play_m(self) -> float:
        """Upper bound of the gap of a ring pin that modification and errors can add, m."""
        change = abs(self._modification("equidistant_m")) + abs(self._modification("radial_m"))
        change += sum(abs(value) for values in self.normal_m.values() for value in values)
        lists = self._keys.get("errors", {}).items()
        largest = sum(max(map(abs, values), default=0.0) for key, values in lists if key.endswith("_m"))
        return float(change + largest + self.rotational_rad * self.eccentricity_m * self.lobes)


@dataclass(frozen=True)
class Masses(Table):
    """Mass and moment of inertia about the centre of mass of each kind of body (Tab. 2)."""

    def of_bodies(self, gear: Gear) -> list[Table]:
        """One entry a body, in the order of `layout`."""
        return (
            [self.input_shaft, self.output_shaft]
            + [self.wheel] * gear.wheels
            + [self.external_sleeve] * gear.external_sleeves
            + [self.internal_sleeve] * gear.internal_sleeves
        )

    def driver_kg_m2(self, wheels: float) -> float:
        """Rotor inertia that stands in for a driver: the power of ten next to so many times a disc's moment.

        The input's speed is then off by torque * time/(inertia * speed), and inertia * deceleration is the torque.
        """
        return float(10.0 ** round(math.log10(wheels * self.wheel.moment_kg_m2)))


@dataclass(frozen=True)
class LoadPiece:
    """The load between two changes: linear from `before_n_m` to `after_n_m` over `ramp_s`, constant outside the ramp.

    At a change without a ramp the load is two: that of the piece that ends and that of the piece that begins. A step
    takes the piece it lies in, at both its ends.
    """

    from_s: float
    before_n_m: float
    after_n_m: float
    ramp_s: float

    def load_n_m(self, time_s: float) -> float:
        """Load on the output shaft at a time."""
        if self.ramp_s <= 0.0:
            return self.after_n_m
        share = min(1.0, max(0.0, (time_s - self.from_s) / self.ramp_s))
        return self.before_n_m + (self.after_n_m - self.before_n_m) * share


@dataclass(frozen=True)
class Drive(Table):
    """Motion of the input and load of the output (Tab. 3).

    A positive load is a torque of that size on the output shaft, which opposes the motion of a positive input speed.
    """

    @property
    def load_changes(self) -> list[dict[str, float]]:
        """Load profile of the run; a constant load has no such key."""
        return list(self._keys.get("load_changes", ()))

    def load_pieces(self) -> list[LoadPiece]:
        """The load from change to change, the first piece from 0 on."""
        pieces = [LoadPiece(0.0, 0.0, self.output_torque_n_m, self.load_ramp_s)]
        for entry in self.load_changes:
            change = Table(entry, "drive.load_changes.")
            pieces.append(LoadPiece(change.time_s, pieces[-1].after_n_m, change.output_torque_n_m, change.ramp_s))
        return pieces

    def load_piece(self, time_s: float) -> LoadPiece:
        """The piece that holds at a time; at a change the one that begins."""
        return [piece for piece in self.load_pieces() if piece.from_s <= max(0.0, time_s)][-1]

    def load_n_m(self, time_s: float) -> float:
        """Load on the output shaft at a time; at a jump what it jumps to."""
        return self.load_piece(time_s).load_n_m(time_s)

    @property
    def load_breaks_s(self) -> list[float]:
        """Times at which the load jumps or bends, which no step may pass over. None without changes, as ever."""
        if not self.load_changes:
            return []
        breaks: list[float] = []
        for piece in self.load_pieces():
            # A ramp that ends where the next change begins, up to rounding, is no break of its own.
            if breaks and piece.from_s - breaks[-1] < APART_S:
                breaks.pop()
            breaks.append(piece.from_s)
            if piece.ramp_s >= APART_S:
                breaks.append(piece.from_s + piece.ramp_s)
        return [time_s for time_s in breaks if time_s > 0.0]

    @property
    def load_varies(self) -> bool:
        """True if the load varies during the run."""
        return bool(self.load_ramp_s > 0.0 or self.load_changes)

    @property
    def largest_load_n_m(self) -> float:
        """The largest size of the load over the run."""
        return max(abs(piece.after_n_m) for piece in self.load_pieces())


@dataclass(frozen=True)
class Contact(Table):
    """Contact law (Eq. 20-24) and detection. Keys that a scene leaves to others say what they stand for then."""

    def _given(self, key: str, other: Any) -> Any:
        value = self._keys.get(key)
        return other if value is None else value

    @property
    def pin_young_pa(self) -> float:
        """E of the pins, Pa; as the discs'."""
        return float(self._given("pin_young_pa", self.young_pa))

    @property
    def pin_poisson(self) -> float:
        """Poisson's ratio of the pins; as the discs'."""
        return float(self._given("pin_poisson", self.poisson))

    @property
    def internal_stiffness_multiplier(self) -> float:
        """H of the internal contacts, of laws of balls; as the external ones'."""
        return float(self._given("internal_stiffness_multiplier", self.stiffness_multiplier))

    @property
    def disc_depth_m(self) -> float | None:
        """Depth of a disc behind a contact, m; None: the wall between a hole and the profile."""
        value = self._keys.get("disc_depth_m")
        return None if value is None else float(value)


@dataclass(frozen=True)
class Solver(Table):
    """Formulation, integrator, sampling. Foreign engines take the step, the duration and the sampling."""

    def sample_times_s(self) -> npt.NDArray[np.float64]:
        """0, sample_s, 2 sample_s, ... and the end itself, which need not be a multiple of the sampling step."""
        count = math.floor(self.duration_s / self.sample_s * (1.0 + 1e-12))
        times = [k * self.sample_s for k in range(count + 1)]
        if self.duration_s - times[-1] > 1e-9 * self.sample_s:
            times.append(self.duration_s)
        else:
            times[-1] = self.duration_s
        return np.array(times, dtype=np.float64)


def _fold_cranks(data: dict[str, Any]) -> None:
    """Effect of the rigid first stage of an RV gear on the eccentrics' angle and the output's inertia."""
    cranks = data.get("cranks")
    if cranks is None:
        return
    rho, gear, mass = cranks["sun_teeth"] / cranks["planet_teeth"], data["gear"], data["mass"]
    if gear["ring_turns"]:
        gear["eccentric_per_input"] = -rho
        return
    gear["eccentric_per_input"] = -rho * (gear["external_sleeves"] - 1) / (gear["external_sleeves"] + rho)
    turning = cranks["count"] * mass["internal_sleeve"]["moment_kg_m2"]
    mass["output_shaft"]["moment_kg_m2"] += (1.0 + rho) ** 2 * turning


def _fold_output(data: dict[str, Any]) -> None:
    """Which part the output is, and the inertia of pins that it holds: the law moves what turns them there."""
    gear, drive = data.get("gear"), data.get("drive")
    if not isinstance(gear, dict) or not isinstance(drive, dict):
        return
    gear["ring_turns"] = drive.get("output") == "ring"
    kind = "external" if gear["ring_turns"] else "internal"
    if not gear.get(f"{kind}_sleeves_turn", True):
        mass = data["mass"]
        mass["output_shaft"]["moment_kg_m2"] += gear[f"{kind}_sleeves"] * mass[f"{kind}_sleeve"]["moment_kg_m2"]


_COMPILED_ONLY = ("eccentric", "sleeve_friction_coefficient", "input_seal_n_m", "output_seal_n_m")


def _compiled_only(data: dict[str, Any]) -> str:
    """First key of a scene that only the compiled law supports; empty: none."""
    bearings = data.get("bearings", {})
    keys = [f"bearings.{key}" for key in _COMPILED_ONLY if bearings.get(key)]
    if data.get("contact", {}).get("friction_coefficient"):
        kinds = ("external_sleeves_turn", "internal_sleeves_turn")
        keys += [f"gear.{key}" for key in kinds if not data.get("gear", {}).get(key, True)]
    return keys[0] if keys else ""


@dataclass(frozen=True)
class Scene:
    """A complete scene. SI units; angles counter-clockwise."""

    name: str
    gear: Gear
    mass: Masses
    drive: Drive
    contact: Contact
    solver: Solver
    # Discs are free bodies on elastic bearings, whose forces the compiled law has.
    floats: bool = False
    # Stiffness of an output pin against bending, in series with its contacts, N/m; None: rigid.
    pin_n_m: float | None = None
    # Friction mu of a sleeve on its pin, which the compiled law has, and the pin's diameter, m.
    sleeve_friction_coefficient: float = 0.0
    sleeve_bore_m: float = 0.0
    # The first key of what the compiled law alone has; empty: none.
    compiled_only: str = ""
    # Patterns of the columns that are wanted beyond those of every run.
    channels: tuple[str, ...] = ()

    @staticmethod
    def of(scene: str | Scene) -> Scene:
        """A scene from itself or from its TOML text."""
        return scene if isinstance(scene, Scene) else Scene.from_toml(scene)

    @staticmethod
    def from_toml(text: str) -> Scene:
        """Reads a complete scene; raises SceneError on malformed TOML. Its values are taken as they are."""
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise SceneError(f"the scene is not valid TOML: {error}") from error

        _fold_output(data)
        _fold_cranks(data)

        def keys(table: str) -> tuple[dict[str, Any], str]:
            values = data.get(table, {})
            if not isinstance(values, dict):
                raise SceneError(f"`{table}` must be a table, not {values!r}")
            return values, f"{table}."

        return Scene(
            str(data.get("name", "unnamed")),
            Gear(*keys("gear")),
            Masses(*keys("mass")),
            Drive(*keys("drive")),
            Contact(*keys("contact")),
            Solver(*keys("solver")),
            "eccentric" in keys("bearings")[0],
            keys("bearings")[0].get("internal_sleeve_stiffness_n_m"),
            keys("bearings")[0].get("sleeve_friction_coefficient", 0.0),
            keys("bearings")[0].get("sleeve_bore_m", 0.0),
            _compiled_only(data),
            tuple(keys("output")[0].get("channels", ())),
        )

    @staticmethod
    def load(path: Path) -> Scene:
        """Reads a scene file; see `from_toml`."""
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise SceneError(f"cannot read the scene file {path}: {error}") from error
        return Scene.from_toml(text)

    def with_keys(self, table: str, **changes: Any) -> Scene:
        """Returns a copy of the scene with other values of keys of a table: `with_keys("solver", duration_s=0.1)`."""
        old = getattr(self, table)
        new = dataclasses.replace(old, _keys={**old._keys, **changes})
        return dataclasses.replace(self, **{table: new})
