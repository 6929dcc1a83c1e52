"""From a catalogue to a scene, from a scene to a designer's figures, and to a co-simulation unit."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pinwheel import _core
from pinwheel._columns import near, wanted
from pinwheel._page import Paged, plain
from pinwheel._progress import Progress, reporting
from pinwheel._scene import Scene
from pinwheel.errors import Missing

if TYPE_CHECKING:
    import pandas

Material = Literal["steel", "cast-iron", "bronze", "aluminium", "pom", "nylon", "pla"]
Process = Literal["ground", "edm", "milled", "printed"]


def gear(
    name: str = "mine",
    *,
    ratio: float,
    pin_circle_diameter_mm: float | None = None,
    outer_diameter_mm: float | None = None,
    torque_n_m: float,
    speed_rpm: float,
    cranks: int | None = None,
    material: Material = "steel",
    pin_material: Material | None = None,
    process: Process | None = None,
    ideal: bool = False,
    pin_diameter_mm: float | None = None,
    eccentricity_mm: float | None = None,
    wheels: int | None = None,
    output_pins: int | None = None,
    output_pin_diameter_mm: float | None = None,
    output_circle_diameter_mm: float | None = None,
    face_width_mm: float | None = None,
    backlash_mm: float | None = None,
    friction: float | None = None,
) -> Scene:
    """A scene from a catalogue's data, as `pinwheel init` makes it: diameters in mm, what is left out is suggested.
    `outer_diameter_mm` suggests the pin circle where none is given. `cranks` makes it an RV gear with so many cranks.
    Clearances, bearings, friction and bending are suggested too, by the `process` of the discs, unless it is `ideal`.

    >>> s = gear(ratio=39, pin_circle_diameter_mm=104, torque_n_m=200, speed_rpm=1500)
    >>> s["external_sleeves"], s["drive.output_torque_n_m"]
    (40, 200.0)
    """

    def metres(length_mm: float | None) -> float | None:
        return None if length_mm is None else 1e-3 * length_mm

    given = {
        "ratio": ratio,
        "cranks": cranks,
        "pin_circle_diameter_m": metres(pin_circle_diameter_mm),
        "outer_diameter_m": metres(outer_diameter_mm),
        "torque_n_m": torque_n_m,
        "speed_rad_s": speed_rpm * pi / 30.0,
        "material": material,
        "pin_material": pin_material,
        "process": process,
        "ideal": ideal,
        "pin_diameter_m": metres(pin_diameter_mm),
        "eccentricity_m": metres(eccentricity_mm),
        "wheels": wheels,
        "output_pins": output_pins,
        "output_pin_diameter_m": metres(output_pin_diameter_mm),
        "output_circle_diameter_m": metres(output_circle_diameter_mm),
        "face_width_m": metres(face_width_mm),
        "backlash_m": metres(backlash_mm),
        "friction": friction,
    }
    return Scene.from_toml(_core.gear(name, given))


@dataclass(frozen=True)
class Figure:
    """A figure of a gear with its known uncertainty; `float(figure)` is its value.

    Attributes:
        key: name for programs, which ends in the unit
        what: what it is, in words
        value: None where it does not exist, such as the efficiency of a gear at rest
        unit: empty for counts
        uncertainty: how far the value may be off numerically; None where that is not known
        by_contact_law: least and largest by the contact laws that may be right for these materials
        by_fit: least and largest over what the scene says is `[uncertain]`
        over_the_mesh: least and largest over the mesh
        over_the_mesh_uncertainty: how far either may be off numerically
        how: how it is counted
        shown: the value with the digits that it is known to
        bounds: in words, how far it is known

    """

    key: str
    what: str
    value: float | None
    unit: str
    uncertainty: float | None
    by_contact_law: tuple[float, float] | None
    by_fit: tuple[float, float] | None
    over_the_mesh: tuple[float, float] | None
    over_the_mesh_uncertainty: tuple[float, float] | None
    how: str
    shown: str
    bounds: str

    def __float__(self) -> float:
        return float("nan") if self.value is None else self.value

    def __str__(self) -> str:
        bounds = f"({self.bounds})" if self.bounds else ""
        return " ".join(filter(None, (f"{self.what}:", self.shown, self.unit, bounds)))


@dataclass(frozen=True)
class Limit:
    """A load of a part against what it may bear.

    Attributes:
        key: name of the limited figure
        what: the figure, in words
        of: the part, or the kind of limit
        unit: of the values
        value: of the figure; None where it is not known
        worst: the value with its uncertainty, at the worse end of its bands
        permissible: what is allowed; None where it is not known
        margin: above 1 the limit holds; None: not judged
        source: where the limit is from, or what to state
        is_stated: you stated it

    """

    key: str
    what: str
    of: str
    unit: str
    value: float | None
    worst: float | None
    permissible: float | None
    margin: float | None
    source: str
    is_stated: bool


class Design(Paged, Mapping[str, Figure]):
    """Figures of a gear by their names: `design["lost_motion_arcmin"].value`.

    Attributes:
        scene: the gear's
        limits: loads of the parts against what they may bear
        bears_its_load: the answer of the limits in words, `yes, margin 1.9`
        data: all results, with courses over the mesh: the program's `design.json`

    """

    def __init__(self, scene: Scene, core: _core.Designed) -> None:
        self.scene = scene
        self.data: dict[str, Any] = json.loads(core.json())
        self._page, self._text, self._dxf = core.page, plain(core.text()), core.dxf()
        self.bears_its_load, _ = core.bears()
        names = [field.name for field in fields(Limit)]
        each_limit = self.data["limits"]["each"]
        self.limits = [Limit(**{name: limit[name] for name in names}) for limit in each_limit]
        each = zip(self.data["figures"], core.words(), strict=True)
        self._figures = {figure["key"]: _figure(figure, *words) for figure, words in each}

    _called = "design"

    def __getitem__(self, key: str) -> Figure:
        if key in self._figures:
            return self._figures[key]
        if key in (known := [figure for figure, *_ in _core.figures()]):
            remedy = "`pinwheel.design` makes runs too, and a part must be stated (docs/design.md)"
            raise Missing(f"`{key}` is not among the figures here; {remedy}")
        raise Missing(f"no figure `{key}`; {near(key, known, self)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._figures)

    def __len__(self) -> int:
        return len(self._figures)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame: a row a figure, by name."""
        rows = []
        for figure in self.values():
            row = {field.name: getattr(figure, field.name) for field in fields(figure)}
            for name in ("by_contact_law", "by_fit", "over_the_mesh", "over_the_mesh_uncertainty"):
                row[f"{name}_least"], row[f"{name}_largest"] = row.pop(name) or (None, None)
            rows.append(row)
        return wanted("pandas", "frames").DataFrame(rows).set_index("key")

    def save_dxf(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Writes a drawing `disc_N.dxf`, in mm, of every disc, or one for equal discs; returns the files."""
        files = [Path(folder) / f"disc_{number}.dxf" for number, _ in self._dxf]
        for file, (_, text) in zip(files, self._dxf, strict=True):
            _core.write(file, text.encode(), "cycloidal disc, millimetres")
        return files

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<Design of {self.scene['name']}: {len(self)} figures>"

    def _repr_html_(self) -> str:
        rows = ((figure.how, (figure.what, figure.shown, figure.unit, figure.bounds)) for figure in self.values())
        return self._table(("", "value", "unit", "known to"), rows)


def _figure(figure: dict[str, Any], shown: str, bounds: str) -> Figure:
    def ends(name: str) -> tuple[float, float] | None:
        band = figure.get(name)
        return None if band is None else (band[0], band[1])

    return Figure(
        key=figure["key"],
        what=figure["what"],
        value=figure["value"],
        unit=figure["unit"],
        uncertainty=figure["numerical_uncertainty"],
        by_contact_law=ends("by_contact_law"),
        by_fit=ends("by_fit"),
        over_the_mesh=ends("over_the_mesh"),
        over_the_mesh_uncertainty=ends("over_the_mesh_numerical_uncertainty"),
        how=figure["how"],
        shown=shown,
        bounds=bounds,
    )


def design(scene: Scene | str, *, progress: bool | Progress | None = None) -> Design:
    """Computes the design figures of a gear under its rated load: lost motion, stiffness, pressure, efficiency and more.

    Statics and a few runs; `statics` leaves the runs out.
    """
    return _design(scene, True, progress)


def statics(scene: Scene | str, *, progress: bool | Progress | None = None) -> Design:
    """Computes the figures of `design` that follow from static balances; without a run, so without efficiency.

    >>> figures = statics("steel")
    >>> figures["torsional_stiffness_n_m_per_arcmin"].unit
    'N m/arcmin'
    """
    return _design(scene, False, progress)


def _design(scene: Scene | str, runs: bool, progress: bool | Progress | None) -> Design:
    made = scene if isinstance(scene, Scene) else Scene(scene)
    with reporting(progress, "design" if runs else "statics") as report:
        return Design(made, _core.design(made._inner, runs, report))


def fmu(scene: Scene | str, path: str | os.PathLike[str], *, author: str | None = None) -> Path:
    """Writes the scene as a co-simulation unit of FMI 2.0 (docs/fmu.md) with its author; returns the file.

    The unit says when it was made, or what the environment's SOURCE_DATE_EPOCH says.
    """
    from pinwheel.__main__ import beside

    made = scene if isinstance(scene, Scene) else Scene(scene)
    target = Path(path)
    _core.write(target, _core.fmu(made._inner, beside("fmu"), author), "")
    return target
