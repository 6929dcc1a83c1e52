"""One scene on one engine."""

from __future__ import annotations

import html
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from pinwheel import _core
from pinwheel._columns import Columns, Floats, plot
from pinwheel._engine import EngineLike
from pinwheel._progress import Told, telling
from pinwheel._scene import Scene
from pinwheel.errors import Diverged

if TYPE_CHECKING:
    import pandas
    import polars
    import xarray


class Run:
    """A run: time series, cost, and what is known of their uncertainty.

    `run["external_sleeve_force_n"]` is an array (samples, sleeves); see `Columns` for the shapes.
    """

    def __init__(self, scene: Scene, core: _core.Ran) -> None:
        self.scene = scene
        self.engine = core.engine
        """Name of the engine."""
        self.version = core.version
        self.track = core.track
        """`native`, `shared-law` or `own-contact`."""
        self.columns = Columns(core.columns)
        self.stats: dict[str, Any] = json.loads(core.stats)
        """What the run cost, its settings and notes; keys end in their unit."""
        self.resolution: dict[str, Any] | None = None if core.resolution is None else json.loads(core.resolution)
        """What the same run at twice its step shows: whether the step resolves the scene."""
        self.uncertainty: dict[str, Any] | None = None if core.uncertainty is None else json.loads(core.uncertainty)
        """What the engine itself verified of its numerical uncertainty."""

    @property
    def time_s(self) -> Floats:
        """Sample times, s, (samples,)."""
        return self.columns.time_s

    @property
    def notes(self) -> list[str]:
        """Remarks of the engine."""
        return list(self.stats["notes"])

    def __getitem__(self, name: str) -> Floats:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def keys(self) -> list[str]:
        """Names of columns, numbered ones by the name they share."""
        return list(self.columns)

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame: a row a sample, `time_s` as its index."""
        return self.columns.to_pandas()

    def to_polars(self) -> polars.DataFrame:
        """A polars DataFrame: a row a sample."""
        return self.columns.to_polars()

    def to_xarray(self) -> xarray.Dataset:
        """A Dataset over `time_s`; sleeves are a dimension."""
        return self.columns.to_xarray()

    def to_csv(self, path: str) -> None:
        """Writes the program's `courses.csv`."""
        self.columns.to_csv(path)

    def plot(self, *names: str, ax: Any = None) -> Any:
        """Draws columns (torques and forces without names) over the time with matplotlib.

        `ax`: axes to draw into, one for each name; without it a new figure. The axes, or an array of them for several names.
        """
        return plot(self.columns, names, f"{self.scene.name}, {self.engine}", ax)

    def __repr__(self) -> str:
        mean = np.mean(self["input_torque_n_m"]) if "input_torque_n_m" in self.columns and self.time_s.size else np.nan
        what = f"{self.scene.name} on {self.engine}: {self.time_s.size} samples"
        return f"<Run of {what}, driver torque {mean:.4g} N m in the mean>"

    def _repr_html_(self) -> str:
        rows = []
        for name in self.keys()[1:]:
            values = self[name]
            count = f" ({values.shape[1]})" if values.ndim == 2 else ""
            cells = (np.mean(values), np.min(values), np.max(values)) if values.size else (np.nan,) * 3
            rows.append(f"<tr><td>{html.escape(name)}{count}</td>" + "".join(f"<td>{x:.5g}</td>" for x in cells) + "</tr>")
        head = "<tr><th></th><th>mean</th><th>min</th><th>max</th></tr>"
        return f"<p>{html.escape(repr(self)[1:-1])}</p><table>{head}{''.join(rows)}</table>"


def run(
    scene: Scene | str, engine: EngineLike = "native", *, check: bool = True, progress: bool | Told | None = None
) -> Run:
    """Runs a scene on an engine: a name of `pinwheel.engines()` or a function made with `@pinwheel.engine`.

    `check`: a native run is made once more at twice its step, which says whether the step resolves the scene. The
    interpreter's lock is free meanwhile; Ctrl-C stops the run.

    Raises `Diverged` with what was computed until then in `partial`, `Unsupported`, `EngineFailed`, `NoEngine`.

    >>> r = run(Scene("paper", duration_s=0.01), "native-reduced")
    >>> r["external_sleeve_force_n"].shape
    (101, 16)
    >>> r.resolution is None
    False
    """
    made = scene if isinstance(scene, Scene) else Scene(scene)
    with telling(progress, "run") as told:
        try:
            return Run(made, _core.run(made._inner, engine, check, told))
        except Diverged as error:
            partial: Any = error.partial
            if isinstance(partial, _core.Ran):
                error.partial = Run(made, partial)
            raise
