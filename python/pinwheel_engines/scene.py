"""The scene: everything a run depends on, as the TOML file names it.

Every key but `name` has a default (the published gearbox), every unit is in the key's name. Unknown keys, wrong types,
values out of range and non-finite numbers are errors that name the key and the remedy.
"""

from __future__ import annotations

import dataclasses
import math
import tomllib
import typing
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import SceneError

# Least distance of two changes of the load, s: more than the rounding of times.
APART_S = 1e-9

Check = typing.Callable[[float], bool]


def _limited(default: Any, test: Check, wanted: str) -> Any:
    """A field whose value must pass `test`; `wanted` completes the sentence 'must be ...'."""
    return field(default=default, metadata={"test": test, "wanted": wanted})


def _positive(default: float) -> Any:
    return _limited(default, lambda x: x > 0, "greater than 0")


def _not_negative(default: float) -> Any:
    return _limited(default, lambda x: x >= 0, "0 or greater")


def _at_least(default: int, least: int) -> Any:
    return _limited(default, lambda n: n >= least, f"{least} or more")


def _one_of(default: str, *names: str) -> Any:
    return field(default=default, metadata={"names": names})


@dataclass(frozen=True)
class Gear:
    """Geometry (Tab. 1 and Fig. 3 of the paper)."""

    eccentricity_m: float = _positive(0.0028)
    external_sleeves: int = _at_least(16, 3)
    shortening: float = _limited(0.7, lambda m: 0 < m < 1, "between 0 and 1, both excluded")
    external_sleeve_radius_m: float = _positive(0.006)
    internal_sleeves: int = _at_least(8, 1)
    internal_sleeve_radius_m: float = _positive(0.006)
    internal_circle_radius_m: float = _positive(0.038)
    hole_radius_m: float = _positive(0.0088)
    wheels: int = _at_least(2, 1)
    backlash_m: float = _not_negative(0.0)

    @property
    def lobes(self) -> int:
        """zs, lobes of a wheel."""
        return self.external_sleeves - 1

    @property
    def pitch_radius_m(self) -> float:
        """R = e zk/m: radius of the circle the external sleeves sit on without backlash."""
        return self.eccentricity_m * self.external_sleeves / self.shortening


@dataclass(frozen=True)
class BodyMass:
    """Mass and moment of inertia about the centre of mass of one rigid body."""

    mass_kg: float = field(metadata={"test": lambda x: x > 0, "wanted": "greater than 0"})
    moment_kg_m2: float = field(metadata={"test": lambda x: x > 0, "wanted": "greater than 0"})


@dataclass(frozen=True)
class Masses:
    """Tab. 2 of the paper."""

    input_shaft: BodyMass = BodyMass(0.2341, 1.846e-6)
    output_shaft: BodyMass = BodyMass(1.6345, 1.373e-4)
    wheel: BodyMass = BodyMass(0.5998, 1.57538e-4)
    internal_sleeve: BodyMass = BodyMass(0.048, 1.1013e-5)
    external_sleeve: BodyMass = BodyMass(0.048, 1.1013e-5)

    def of_bodies(self, gear: Gear) -> list[BodyMass]:
        """One entry a body, in the order of `layout`."""
        return (
            [self.input_shaft, self.output_shaft]
            + [self.wheel] * gear.wheels
            + [self.external_sleeve] * gear.external_sleeves
            + [self.internal_sleeve] * gear.internal_sleeves
        )


@dataclass(frozen=True)
class LoadChange:
    """What the load becomes during a run: at once, or linearly over `ramp_s`."""

    time_s: float = field(metadata={"test": lambda t: t >= APART_S, "wanted": f"{APART_S:g} s or later"})
    output_torque_n_m: float
    ramp_s: float = _limited(0.0, lambda t: t == 0 or t >= APART_S, f"0 or at least {APART_S:g} s")


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
class Drive:
    """Motion of the input and load of the output (Tab. 3).

    A positive load is a torque of that size on the output shaft, which opposes the motion of a positive input speed.
    """

    input_speed_rad_s: float = 52.34
    output_torque_n_m: float = 22.0
    start: str = _one_of("kinematic", "kinematic", "equilibrium")
    load_ramp_s: float = _not_negative(0.0)

    load_changes: tuple[LoadChange, ...] = ()

    def load_pieces(self) -> list[LoadPiece]:
        """The load from change to change, the first piece from 0 on."""
        pieces = [LoadPiece(0.0, 0.0, self.output_torque_n_m, self.load_ramp_s)]
        for change in self.load_changes:
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
        """Whether the load is not the same from the start to the end."""
        return self.load_ramp_s > 0.0 or bool(self.load_changes)

    @property
    def largest_load_n_m(self) -> float:
        """The largest size of the load over the run."""
        return max(abs(piece.after_n_m) for piece in self.load_pieces())


@dataclass(frozen=True)
class Contact:
    """Contact law (Eq. 20-24) and detection.

    The keys from `friction_law` to `line_length_m` belong to laws other than the paper's, which only the compiled law knows.
    """

    law: str = "paper"
    young_pa: float = _positive(2.0e11)
    poisson: float = _limited(0.3, lambda nu: -1 < nu <= 0.5, "above -1 and at most 0.5")
    stiffness_multiplier: float = _positive(0.01)
    damping_n_s_m: float = _not_negative(8.0)
    ramp_m: float = _positive(1.0e-5)
    friction_coefficient: float = _not_negative(0.0)
    friction_ramp_m_s: float = _positive(5.0e-5)
    friction_law: str = _one_of("regularised", "regularised", "adams")
    friction_dynamic_coefficient: float = _not_negative(0.0)
    friction_dynamic_speed_m_s: float = _positive(1.0e-3)
    constant_stiffness_n_m15: float = _positive(1.0e8)
    restitution: float = _limited(0.9, lambda c: 0 < c <= 1, "above 0 and at most 1")
    impact_speed_m_s: float = _positive(0.01)
    line_length_m: float = _positive(0.01)
    detection: str = _one_of("exact", "exact", "points")
    wheel_points: int = _at_least(4000, 3)
    hole_points: int = _at_least(100, 3)


@dataclass(frozen=True)
class Solver:
    """Formulation, integrator, sampling. Foreign engines take the step, the duration and the sampling."""

    formulation: str = _one_of("reduced", "reduced", "lagrange")
    integrator: str = "rk2"
    step_s: float = _positive(1.0e-5)
    tolerance: float = _positive(1.0e-6)
    duration_s: float = _positive(0.6)
    sample_s: float = _positive(1.0e-4)
    stabilisation: str = _one_of("projection", "none", "baumgarte", "projection")

    def sample_times_s(self) -> npt.NDArray[np.float64]:
        """0, sample_s, 2 sample_s, ... and the end itself, which need not be a multiple of the sampling step."""
        whole = math.floor(self.duration_s / self.sample_s * (1.0 + 1e-12))
        times = [k * self.sample_s for k in range(whole + 1)]
        if self.duration_s - times[-1] > 1e-9 * self.sample_s:
            times.append(self.duration_s)
        else:
            times[-1] = self.duration_s
        return np.array(times)


@dataclass(frozen=True)
class Scene:
    """A complete scene. SI units; angles counter-clockwise."""

    name: str = "unnamed"
    description: str = ""
    gear: Gear = Gear()
    mass: Masses = Masses()
    drive: Drive = Drive()
    contact: Contact = Contact()
    solver: Solver = Solver()

    # Tables of the file, for messages only.
    TABLES: ClassVar[tuple[str, ...]] = ("gear", "mass", "drive", "contact", "solver")

    @staticmethod
    def from_toml(text: str) -> Scene:
        """Reads and checks a scene.

        Raises SceneError on malformed TOML, unknown keys, wrong types, values out of range, inconsistent geometry.
        """
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise SceneError(f"the scene is not valid TOML: {error}") from error
        # Channels beyond the contract's columns, which these engines do not record: no physics in it.
        data.pop("output", None)
        scene = _read(Scene, data, "")
        assert isinstance(scene, Scene)
        _check_geometry(scene.gear)
        _check_changes(scene.drive)
        return scene

    @staticmethod
    def load(path: Path) -> Scene:
        """Reads a scene file; see `from_toml`."""
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise SceneError(f"cannot read the scene file {path}: {error}") from error
        return Scene.from_toml(text)

    def with_solver(self, **changes: float) -> Scene:
        """The same scene with other solver keys (`duration_s`, `step_s`, `sample_s`, ...)."""
        return dataclasses.replace(self, solver=dataclasses.replace(self.solver, **changes))  # type: ignore[arg-type]

    def to_toml(self) -> str:
        """The whole scene as TOML text, every key present; `from_toml` reads it back unchanged."""
        lines = [f"name = {_quoted(self.name)}", f"description = {_quoted(self.description)}"]
        for table in self.TABLES:
            lines.append(f"[{table}]")
            part = getattr(self, table)
            lines += [f"{f.name} = {_toml_value(getattr(part, f.name))}" for f in dataclasses.fields(part)]
        return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    escaped = "".join(
        f"\\u{ord(c):04x}" if ord(c) < 32 or ord(c) == 127 else {'"': '\\"', "\\": "\\\\"}.get(c, c) for c in text
    )
    return f'"{escaped}"'


def _toml_value(value: Any) -> str:
    if dataclasses.is_dataclass(value):
        inner = ", ".join(f"{f.name} = {_toml_value(getattr(value, f.name))}" for f in dataclasses.fields(value))
        return f"{{ {inner} }}"
    if isinstance(value, tuple):
        return f"[{', '.join(_toml_value(entry) for entry in value)}]"
    return _quoted(value) if isinstance(value, str) else repr(value)


def _read(kind: type[Any], data: dict[str, Any], where: str) -> Any:
    """Fills the dataclass `kind` from a TOML table; `where` is the table's dotted name."""
    types = typing.get_type_hints(kind)
    fields = {f.name: f for f in dataclasses.fields(kind)}
    for key in data:
        if key not in fields:
            known = ", ".join(fields)
            raise SceneError(f"unknown key `{where}{key}`; remove it or use one of: {known}")
    values: dict[str, Any] = {}
    for name, description in fields.items():
        if name in data:
            values[name] = _value(types[name], data[name], f"{where}{name}", description.metadata)
        elif description.default is dataclasses.MISSING:
            raise SceneError(f"key `{where}{name}` is missing; give it a value")
    return kind(**values)


def _value(kind: type[Any], raw: Any, key: str, rules: typing.Mapping[str, Any]) -> Any:
    """One value, converted and checked."""
    if dataclasses.is_dataclass(kind):
        if not isinstance(raw, dict):
            raise SceneError(f"`{key}` must be a table, not {raw!r}")
        return _read(kind, raw, f"{key}.")
    if typing.get_origin(kind) is tuple:
        if not isinstance(raw, list):
            raise SceneError(f"`{key}` must be a list of tables, not {raw!r}")
        entry = typing.get_args(kind)[0]
        return tuple(_value(entry, one, f"{key}[{number}]", {}) for number, one in enumerate(raw))
    if kind is str:
        if not isinstance(raw, str):
            raise SceneError(f"`{key}` must be a text in quotes, not {raw!r}")
        names = rules.get("names")
        if names is not None and raw not in names:
            raise SceneError(f"`{key}` = {raw!r} is not known; use one of: {', '.join(names)}")
        return raw
    if isinstance(raw, bool) or not isinstance(raw, int | float):
        raise SceneError(f"`{key}` must be a number, not {raw!r}")
    if kind is int:
        if not isinstance(raw, int):
            raise SceneError(f"`{key}` must be a whole number, not {raw!r}")
    else:
        raw = float(raw)
    if not math.isfinite(raw):
        raise SceneError(f"`{key}` = {raw!r} is not finite; give a finite number")
    test: Check | None = rules.get("test")
    if test is not None and not test(raw):
        raise SceneError(f"`{key}` = {raw!r} must be {rules['wanted']}")
    return raw


def smallest_convex_radius_m(gear: Gear) -> float:
    """Smallest radius of curvature of the epitrochoid where it is convex, m; a larger sleeve undercuts the wheel.

    With u = |C'|^2/R^2 = 1 + m^2 + 2 m cos(zs a) the curvature is (A + B u)/(R u^1.5), greatest at u = -3 A/B or at the
    nearer end of u's range (1 -+ m)^2.
    """
    m, zk = gear.shortening, gear.external_sleeves
    a, b = -0.5 * (zk - 1) * (1.0 - m * m), 0.5 * (zk + 1)
    u = min(max(-3.0 * a / b, (1.0 - m) ** 2), (1.0 + m) ** 2)
    return float(gear.pitch_radius_m * u**1.5 / (a + b * u))


def _check_changes(drive: Drive) -> None:
    """The changes of the load must come in order, each after the ramp before it."""
    over_s = drive.load_ramp_s
    for number, piece in enumerate(drive.load_pieces()[1:]):
        earlier = drive.load_pieces()[number]
        if (number > 0 and piece.from_s - earlier.from_s < APART_S) or over_s > piece.from_s + 0.5 * APART_S:
            raise SceneError(
                f"`drive.load_changes[{number}].time_s` = {piece.from_s!r} must come after the change before it and its "
                f"ramp, {over_s!r} s; list the changes in the order in which they come"
            )
        over_s = piece.from_s + piece.ramp_s


def _check_geometry(gear: Gear) -> None:
    """What no single key can tell: the profile must not be undercut and the sleeves must fit their holes."""
    q, limit = gear.external_sleeve_radius_m, smallest_convex_radius_m(gear)
    if q >= limit:
        raise SceneError(
            f"`gear.external_sleeve_radius_m` = {q!r} undercuts the wheel profile; it must be below {limit:.6g} m, "
            "or take a larger eccentricity or a smaller shortening"
        )
    if gear.hole_radius_m <= gear.internal_sleeve_radius_m:
        raise SceneError(
            f"`gear.hole_radius_m` = {gear.hole_radius_m!r} must be larger than "
            f"`gear.internal_sleeve_radius_m` = {gear.internal_sleeve_radius_m!r}"
        )
