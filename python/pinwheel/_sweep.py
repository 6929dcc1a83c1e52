"""Sweeps: one scene with many values of its keys, by threads here or by workers of a cluster."""

from __future__ import annotations

import csv
import difflib
import hashlib
import inspect
import json
import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np
import numpy.typing as npt

from pinwheel import _core
from pinwheel._columns import near, quantity, unit, wanted
from pinwheel._engine import Engine, EngineLike, number_of, several
from pinwheel._keys import Keys, Vary
from pinwheel._page import Paged, plain
from pinwheel._progress import Progress, reporting
from pinwheel._scene import Scene, settings, toml_value
from pinwheel.errors import InputError, Missing, SceneError

if TYPE_CHECKING:
    import pandas
    import polars
    import xarray
    from distributed import Client


class Sweep(Paged, Mapping[str, npt.NDArray[Any]]):
    """The results of a sweep: a row a run, in the order of the plan.

    `sweep["mean_input_torque_n_m"]` is an array (runs,): numbers with NaN, texts with "", where there is no value.

    Attributes:
        name: of the sweep
        out: the output folder, as `pinwheel sweep` writes it
        keys_varied: in full
        unfinished: number of runs that did not finish; their rows say why
        cpu_s: CPU time of all runs
        tolerances: what a sample says: for each engine quantiles, sensitivities, and the yield

    """

    # Equality of arrays is an array.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    name: str
    out: Path
    keys_varied: tuple[str, ...]
    unfinished: int
    cpu_s: float
    tolerances: list[dict[str, Any]]

    _called = "sweep"

    @classmethod
    def _of(cls, core: _core.Sweep) -> Sweep:
        made = cls()
        made.name, made.out, made.keys_varied = core.name(), Path(core.out()), tuple(core.keys())
        made._columns = {name: _array(values) for name, values in core.columns()}
        made.unfinished, made.cpu_s = core.broken()[0], core.cpu_s()
        made.tolerances, made._text = json.loads(core.tolerances()), plain(core.text())
        return made

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Sweep:
        """The sweep of an output folder, which this package or the program wrote."""
        made = cls()
        made.out = Path(folder)
        data = json.loads((made.out / "summary.json").read_text(encoding="utf-8"))
        made.name, made.keys_varied = data["name"], tuple(data["keys"])
        with (made.out / "results.csv").open(encoding="utf-8", newline="") as file:
            names = next(csv.reader(file))
        rows = data["rows"]
        made._columns = {name: _array([row.get(name) for row in rows]) for name in names}
        made.unfinished = data["runs"] - data["finished"]
        with (made.out / "costs.csv").open(encoding="utf-8", newline="") as file:
            made.cpu_s = sum(float(row["cpu_s"] or 0.0) for row in csv.DictReader(file))
        made.tolerances, made._text = data.get("sample") or [], repr(made)
        return made

    def __init__(self) -> None:
        self._columns: dict[str, npt.NDArray[Any]] = {}
        self._text = ""

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        if name in self._columns:
            return self._columns[name]
        if (full := [key for key in self.keys_varied if key.rpartition(".")[2] == name])[:2] == full[:1] != []:
            return self._columns[full[0]]
        raise Missing(f"no column `{name}`; {near(name, self, self)}")

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    def to_xarray(self) -> xarray.Dataset:
        """A Dataset by the CF conventions: a dimension for the engine and each key where all combinations were run, else
        one for the runs.
        """
        xarray = wanted("xarray", "frames")
        frame = self.to_pandas()
        axes = [name for name in ("engine", *self.keys_varied) if name == "engine" or frame[name].nunique() > 1]
        full = not frame.duplicated(axes).any() and len(frame) == np.prod([frame[name].nunique() for name in axes])
        dataset = xarray.Dataset.from_dataframe(frame.set_index(axes if full else "run"))
        known = _core.keys()
        keys = {name: {"units": text or "1"} for name, _, text in known}
        for name in (str(name) for name in (*dataset.data_vars, *dataset.coords)):
            if dataset[name].dtype.kind in "if":
                dataset[name].attrs |= keys.get(name) or {"units": unit(name), "long_name": quantity(name)}
        about = {"Conventions": "CF-1.11", "source": f"pinwheel {_core.__version__}"}
        return dataset.assign_attrs(sweep=self.name, pinwheel_version=_core.__version__, **about)

    def tolerances_to_pandas(self) -> pandas.DataFrame:
        """Statistics of a sample: a row for each engine and figure, its quantiles with their confidence intervals."""
        rows = []
        for statistics in self.tolerances:
            for one in statistics["figures"]:
                least, largest = one["range"]
                row = {"engine": statistics["engine"], "figure": one["key"], "count": one["count"], "mean": one["mean"]}
                row |= {"deviation": one["deviation"], "least": least, "largest": largest}
                for quantile in one["quantiles"]:
                    share = f"quantile_{100 * quantile['share']:g}_percent"
                    low, high = quantile["interval"]
                    row |= {share: quantile["value"], f"{share}_from": low, f"{share}_to": high}
                rows.append(row)
        return wanted("pandas", "frames").DataFrame(rows)

    def plot(self, name: str, ax: Any = None) -> Any:
        """Draws a column over the keys that vary: lines over one, a map over two, of the first engine; the axes."""
        pyplot = wanted("matplotlib.pyplot", "plot")
        _ = self[name]
        grid = self.to_xarray()[name]
        if ("engine" in grid.dims and grid.sizes["engine"] == 1) or grid.ndim > 2:
            grid = grid.isel(engine=0)
        if ax is None:
            _, ax = pyplot.subplots(layout="constrained")
        if grid.ndim == 2 and "engine" not in grid.dims:
            grid.plot.pcolormesh(ax=ax, cbar_kwargs={"label": f"{quantity(name)}, {unit(name)}"})
        elif grid.ndim <= 2:
            grid.plot.line(ax=ax, marker="o", **({"hue": "engine"} if "engine" in grid.dims else {}))
            ax.set_ylabel(f"{quantity(name)}, {unit(name)}")
        else:
            raise InputError(f"`{name}` varies over {grid.ndim} keys; choose of to_xarray()")
        return ax

    def __iter__(self) -> Any:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def to_pandas(self) -> pandas.DataFrame:
        """The results as a DataFrame."""
        return wanted("pandas", "frames").DataFrame(self._columns)

    def to_polars(self) -> polars.DataFrame:
        """The results as a polars DataFrame."""
        return wanted("polars", "frames").DataFrame(self._columns)

    def page(self) -> str:
        """The page that opens offline, HTML."""
        return (self.out / "index.html").read_text(encoding="utf-8")

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        count = self._columns["run"].size
        left = f", {self.unfinished} did not finish" if self.unfinished else ""
        return f"<Sweep {self.name}: {count} runs{left}; {self.out}>"

    def _repr_html_(self) -> str:
        names = ["run", "engine", *self.keys_varied, "status"]
        figures = list(self)[list(self).index("rhs_calls") + 1 :]
        moves = any(name.startswith("peak_") for name in figures)  # balances have statistics over the mesh
        chosen = [name for name in figures if name.startswith(("mean_", "peak_")) or not moves]
        names += [name for name in chosen if self[name].dtype.kind == "f"][:6]
        rows = []
        for row in range(min(self["run"].size, 20)):
            cells = (self[name][row] for name in names)
            rows.append(("", [f"{cell:.5g}" if isinstance(cell, float) else str(cell) for cell in cells]))
        return self._table(names, rows)


def _array(values: Sequence[Any]) -> npt.NDArray[Any]:
    if any(isinstance(value, str) for value in values):
        return np.array(["" if value is None else value for value in values])
    if all(isinstance(value, int) for value in values):
        return np.array(values, dtype=np.int64)
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def _text(
    scene: Scene,
    top: Mapping[str, Any],
    vary: Mapping[str, Any],
    together: Sequence[Mapping[str, Any]],
    sample: Mapping[str, Any],
    specification: Mapping[str, Any],
    folder: str,
) -> str:
    """Writes the text of a sweep file for a scene and its varied keys."""
    name, _, sets = scene._inner.spec()
    if name not in _core.presets():
        # The complete scene, independent of its source.
        path = Path(folder) / "scene.toml"
        path.write_text(scene.to_toml(), encoding="utf-8")
        name, sets = str(path), []
    lines = [f"name = {toml_value(scene.name)}", f"scene = {toml_value(name)}"]
    lines += [f"{key} = {toml_value(value)}" for key, value in top.items() if value is not None]
    varied, *joined = [
        [
            (_core.key(key), toml_value(values if isinstance(values, Mapping) else _values(key, values)))
            for key, values in axis.items()
        ]
        for axis in (vary, *together)
    ]
    drawn = [
        (key if key in ("points", "seed", "method") else _core.key(key), toml_value(value)) for key, value in sample.items()
    ]
    names = {key for key, _ in [*varied, *drawn, *(pair for axis in joined for pair in axis)]}
    lines += ["[set]", *(f"{key} = {value}" for key, value in dict(sets).items() if key not in names)]
    lines += ["[vary]", *(f"{key} = {value}" for key, value in varied)]
    for axis in joined:
        lines += ["[[together]]", *(f"{key} = {value}" for key, value in axis)]
    if drawn:
        lines += ["[sample]", *(f"{key} = {value}" for key, value in drawn)]
    if specification:
        lines += ["[specification]", *(f"{key} = {toml_value(value)}" for key, value in specification.items())]
    return "\n".join([*lines, ""])


def _check_words(keys: Mapping[str, Any]) -> None:
    """Refuses a word that is no key of a scene, and suggests the argument of `sweep` that it resembles."""
    arguments = list(inspect.signature(sweep).parameters)[1:-1]
    for word in keys:
        try:
            _core.key(word)
        except SceneError as error:
            if word == "courses":
                meant = "give `time_series`, as a sweep's time series are called here"
            elif close := difflib.get_close_matches(word, arguments, n=1):
                meant = f"did you mean `{close[0]}`?"
            else:
                raise
            raise InputError(f"`{word}` is no argument of a sweep, and no key of a scene; {meant}") from error


def _values(key: str, values: Any) -> list[Any]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise InputError(f'`{key}` varies over one value; give a list, or {{"from": 0.0, "to": 1.0, "points": 11}}')
    return [value.item() if hasattr(value, "item") else value for value in values]


def sweep(
    source: Scene | str | os.PathLike[str],
    *,
    vary: Vary | None = None,
    together: Vary | Sequence[Vary] = (),
    sample: Mapping[str, Any] | None = None,
    specification: Mapping[str, Any] | None = None,
    engines: Sequence[EngineLike] | EngineLike = (),
    measure: Sequence[str] | None = None,
    window_s: Sequence[float] | None = None,
    time_series: Literal["none", "csv", "parquet"] | None = None,
    client: Client | None = None,
    jobs: int | None = None,
    batch: int | None = None,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    force: bool = False,
    progress: bool | Progress | None = None,
    **keys: Unpack[Keys],
) -> Sweep:
    """Runs a sweep and writes its output folder, which is the same byte for byte however it is run.

    `source`: a sweep file (docs/sweeps.md), or a scene with `vary`: keys with lists, arrays, or ranges
    `{"from": 0.0, "to": 1e-3, "points": 11}`; all combinations are run. `sample` takes keys at random instead, or besides:
    `{"points": 1000, "backlash_m": {"from": 0.0, "to": 1e-5}}`; `specification`: limits on columns of the results,
    `{"lost_motion_arcmin": {"most": 1.0}}`, and the yield in `tolerances`. `together`: keys that change in step, one axis;
    a list of such gives several. `time_series`: keep those of every run, "csv", or
    "parquet" where it is built in. `keys` are set in every run.
    `client`: a `distributed.Client`, whose workers then do the runs in batches (of `batch` runs; by itself about half a
    second of work); without it `jobs` threads do. Finished runs are kept beside the output, in `OUT.unfinished`, in the
    same form as the program keeps them: `resume` goes on with those, and with the runs of an earlier output in `out`.
    `force` begins anew, and replaces an earlier output of which files were changed; foreign files stay.

    A run that diverges has a row that says so, and is not tried again. Raises `SceneError`, `InputError`, `ClusterError`,
    `OSError`; after `KeyboardInterrupt` and `ClusterError` finished runs are kept.
    """
    threads = number_of(jobs)
    _check_words(keys)
    with ExitStack() as stack:
        axes = [together] if isinstance(together, Mapping) else list(together)
        preset = not isinstance(source, Scene) and not os.fspath(source).endswith(".toml")
        if isinstance(source, Scene) or preset or vary is not None or sample is not None or axes:
            scene = source if isinstance(source, Scene) else Scene(source)
            if not vary and not sample and not axes:
                raise InputError('nothing varies; give vary={"backlash_m": [0, 1e-5]}, together, sample, or a sweep file')
            folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="pinwheel-"))
            scene = scene.with_(**keys) if keys else scene
            top = {"measure": measure, "window_s": window_s, "courses": time_series}
            text = _text(scene, top, vary or {}, axes, sample or {}, specification or {}, folder)
            path = "sweep.toml"
            if out is None:
                # Different sweeps have different folders; a repeated sweep has its own again.
                identity = [scene.to_toml(), text.replace(folder, "."), *(repr(engine) for engine in several(engines))]
                name = re.sub(r"[^\w.-]", "-", scene.name).lstrip(".")
                out = Path("out") / f"{name}-sweep-{hashlib.sha256(''.join(identity).encode()).hexdigest()[:8]}"
            sets: list[tuple[str, str]] = []
        else:
            if any(given is not None for given in (measure, window_s, specification, time_series)):
                given = "`measure`, `window_s`, `specification` and `courses`"
                raise InputError(f"a sweep file has {given} itself; write them there")
            path = os.fspath(source)
            try:
                text = Path(path).read_text(encoding="utf-8")
            except (OSError, UnicodeDecodeError) as error:
                raise InputError(f"{path}: cannot be read: {error}; give a sweep file (TOML), see docs/sweeps.md") from error
            sets = settings(keys)
        asked = several(engines)
        core = _core.Sweep(text, path, sets, asked, None if out is None else os.fspath(out), resume, force)
        try:
            with reporting(progress, core.name()) as report:
                if client is None:
                    core.execute(threads, report)
                else:
                    from pinwheel._cluster import execute

                    own = tuple(engine for engine in asked if isinstance(engine, Engine))
                    execute(client, core, own, batch, report)
            core.finish()
        finally:
            core.close()
        return Sweep._of(core)
