"""One scene on one engine."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pinwheel import _core
from pinwheel._columns import Columns, Floats, plot
from pinwheel._engine import EngineLike
from pinwheel._page import plain
from pinwheel._progress import Progress, reporting
from pinwheel._scene import Scene
from pinwheel.errors import Diverged, InputError

if TYPE_CHECKING:
    import pandas
    import polars
    import xarray

    from pinwheel._keys import Column

# Facts of a run beside its time series, by their names in `run.json`.
KNOWN = ("resolution", "numerical_uncertainty", "results", "by_contact_law")


@dataclass(frozen=True, eq=False, repr=False)
class Run(Mapping["Column", Floats]):
    """A run: time series, their cost and their known uncertainty.

    `run["external_sleeve_force_n"]` is an array (samples, pins); see `Columns` for the shapes and names.

    Attributes:
        scene: what was run
        engine: name of the engine
        version: of the engine
        track: "native", "shared-law" or "own-contact"
        columns: the time series
        stats: what the run cost, its settings and notes; keys end in their unit
        resolution: comparison with a run at twice the step, which shows if the step resolves the scene
        uncertainty: numerical uncertainty verified by the engine itself
        results: figures with their uncertainty: the program's `results` of `run.json`
        by_contact_law: figures under other contact laws

    """

    # Equality of arrays is an array.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    scene: Scene
    engine: str
    version: str
    track: Literal["native", "shared-law", "own-contact"]
    columns: Columns
    stats: dict[str, Any]
    resolution: dict[str, Any] | None = None
    uncertainty: dict[str, Any] | None = None
    results: dict[str, Any] | None = None
    by_contact_law: dict[str, Any] | None = None
    _text: str = ""

    @classmethod
    def _of(cls, scene: Scene, core: _core.Ran) -> Run:
        texts = (core.stats, core.resolution, core.uncertainty, core.results, core.by_contact_law)
        parts: list[Any] = [*(None if text is None else json.loads(text) for text in texts), core.text]
        return cls(scene, core.engine, core.version, core.track, Columns(core.columns), *parts)

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Run:
        """Reads a run that `save` or the program's `run` wrote."""
        try:
            data = json.loads((Path(folder) / "run.json").read_text(encoding="utf-8"))
            columns = Columns.read_csv(Path(folder) / "courses.csv")
            scene = Scene(_written(data.pop("scene")))
            engine, version, track = (data.pop(key) for key in ("engine", "version", "track"))
        except (AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
            raise InputError(f"{folder}: holds no run that pinwheel wrote ({error}); name the folder of one") from error
        known = [data.pop(key, None) for key in KNOWN]
        return cls(scene, engine, version, track, columns, data, *known)

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes `run.json` and `courses.csv`, which `load` reads."""
        place = Path(folder)
        data = {"engine": self.engine, "version": self.version, "track": self.track, **self.stats}
        known = (self.resolution, self.uncertainty, self.results, self.by_contact_law)
        data |= {**dict(zip(KNOWN, known, strict=True)), "scene": self.scene.to_dict()}
        _core.write(place / "run.json", (json.dumps(data, indent=1) + "\n").encode(), '"engine"')
        self.to_csv(place / "courses.csv")

    @property
    def time_s(self) -> Floats:
        """Sample times, s, (samples,)."""
        return self.columns.time_s

    @property
    def notes(self) -> list[str]:
        """Remarks of the engine."""
        return list(self.stats["notes"])

    def __getitem__(self, name: Column) -> Floats:
        return self.columns[name]

    def column(self, name: str) -> Floats:
        """Returns the column of any name, such as `f"external_sleeve_force_n_{k}"`."""
        return self.columns.column(name)

    def __iter__(self) -> Iterator[Column]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def _ipython_key_completions_(self) -> list[str]:
        return self.columns._ipython_key_completions_()

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame: a row a sample, `time_s` as its index."""
        return self.columns.to_pandas()

    def to_polars(self) -> polars.DataFrame:
        """A polars DataFrame: a row a sample."""
        return self.columns.to_polars()

    def to_xarray(self) -> xarray.Dataset:
        """A Dataset over `time_s` and the pins, each at its angle, by the CF conventions; attributes say what was run."""
        dataset = self.columns.to_xarray()
        for part in ("external", "internal"):
            if (dim := f"{part}_sleeve") in dataset.sizes:
                angles = 2.0 * np.pi * np.arange(dataset.sizes[dim]) / dataset.sizes[dim]
                described = {"units": "rad", "long_name": "angle of the pin"}
                dataset = dataset.assign_coords({f"{dim}_angle_rad": (dim, angles, described)})
        return dataset.assign_attrs(
            title=f"{self.scene.name} on {self.engine}", scene=self.scene["name"],
            scene_toml=self.scene.to_toml(), engine=self.engine, engine_version=self.version,
            pinwheel_version=_core.__version__,
        )  # fmt: skip

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the program's `courses.csv`."""
        self.columns.to_csv(path)

    def plot(self, *names: Column, ax: Any = None) -> Any:
        """Draws columns (torques and forces without names) over the time with matplotlib.

        `ax`: axes to draw into, one for each name; without it a new figure. The first axes; all are in `.figure.axes`.
        """
        return plot(self.columns, names, f"{self.scene.name}, {self.engine}", ax)

    def __repr__(self) -> str:
        return f"<Run of {self.scene.name} on {self.engine}: {self.time_s.size} samples>"

    def __str__(self) -> str:
        return plain(self._text) or repr(self)

    def _repr_html_(self) -> str:
        names = ", ".join(f"{name} {self[name].shape[1:] or ''}".strip() for name in self)
        text = f"<pre style='font-family:monospace'>{html.escape(str(self))}</pre>"
        return f"{text}<details><summary>columns</summary>{html.escape(names)}</details>"


def _written(table: Mapping[str, Any]) -> dict[str, Any]:
    """A scene's tables without the keys that have no value."""
    return {
        key: _written(value) if isinstance(value, Mapping) else value for key, value in table.items() if value is not None
    }


def run(
    scene: Scene | str, engine: EngineLike = "native", *, check: bool = True, progress: bool | Progress | None = None
) -> Run:
    """Runs a scene on an engine: a name of `pinwheel.engines()` or a function made with `@pinwheel.engine`.

    `check`: a native run is made once more at twice its step, which says whether the step resolves the scene, and balances
    say what other contact laws would give. The interpreter's lock is free meanwhile; Ctrl-C stops the run.

    Raises `Diverged` with what was computed until then in `partial`, `Unsupported`, `EngineFailed`, `NoEngine`.

    >>> r = run(Scene("paper", duration_s=0.01), "native-reduced")
    >>> r["external_sleeve_force_n"].shape
    (101, 16)
    >>> r.resolution is None
    False
    """
    made = scene if isinstance(scene, Scene) else Scene(scene)
    with reporting(progress, "run") as report:
        try:
            return Run._of(made, _core.run(made._inner, engine, check, report))
        except Diverged as error:
            partial: Any = error.partial
            if isinstance(partial, _core.Ran):
                error.partial = Run._of(made, partial)
            raise
