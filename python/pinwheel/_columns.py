"""Tables of numbers, and their forms in other libraries."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from pinwheel import _core
from pinwheel.errors import InputError, Missing

if TYPE_CHECKING:
    import pandas
    import polars
    import xarray

    from pinwheel._keys import Column

Floats = npt.NDArray[np.float64]
_NUMBERED = re.compile(r"(.+)_(\d+)")


def wanted(package: str, extra: str) -> Any:
    """Imports an optional package, or raises an error that says how to install it."""
    import importlib

    try:
        return importlib.import_module(package)
    except ImportError as error:
        name = package.split(".")[0]
        raise ImportError(f"{name} is not installed; pip install {name}, or pinwheel-dynamics[{extra}]") from error


def near(name: str, known: Iterable[str], listed: Iterable[str]) -> str:
    """Returns names close to a wrong one."""
    import difflib

    close = difflib.get_close_matches(name, list(known), n=1)
    return f"did you mean `{close[0]}`?" if close else f"there are {', '.join(listed)}"


def number(name: str) -> int:
    """The number that ends a column's name."""
    return int(name.rpartition("_")[2])


class Columns(Mapping["Column", Floats]):
    """Time series on common sample times.

    A name of a column gives an array (samples,); the name that numbered columns share gives (samples, columns), the
    columns in the order of their numbers. Arrays are read-only views of one block. Type checkers know the names;
    `column` takes one that is made as the program runs.

    Attributes:
        names: Columns after `time_s`, each ending in its unit, and in a number where there are several
        time_s: Sample times, s, (samples,)

    """

    # Equality of arrays is an array.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __init__(self, core: _core.Columns) -> None:
        self.names: tuple[str, ...] = tuple(core.names())
        self.time_s: Floats = np.frombuffer(core.time())
        self._block: Floats = np.frombuffer(core.values()).reshape(len(self.names), self.time_s.size)
        self._index = {name: k for k, name in enumerate(self.names)}
        self._groups: dict[str, list[int]] = {}
        for k, name in enumerate(self.names):
            if (match := _NUMBERED.fullmatch(name)) is not None:
                self._groups.setdefault(match[1], []).append(k)

    def __getitem__(self, name: Column) -> Floats:
        return self.column(name)

    def column(self, name: str) -> Floats:
        """Returns the column of any name, such as `f"external_sleeve_force_n_{k}"`."""
        if name == "time_s":
            return self.time_s
        if name in self._index:
            return np.asarray(self._block[self._index[name]])
        if (group := self._groups.get(name)) is not None:
            first, count = group[0], len(group)
            if group == list(range(first, first + count)):
                return np.asarray(self._block[first : first + count].T)
            return np.asarray(self._block[group].T)
        raise Missing(f"no column `{name}`; {near(name, [*self._groups, *self.names], self)}")

    def full_names(self, name: str) -> list[str]:
        """Full names of the columns of a name."""
        return [self.names[k] for k in self._groups[name]] if name in self._groups else [name]

    def _ipython_key_completions_(self) -> list[str]:
        return [*self, *self.names]

    def __iter__(self) -> Iterator[Column]:
        yield "time_s"
        grouped = {k for group in self._groups.values() for k in group}
        yielded: set[str] = set()
        for k, name in enumerate(self.names):
            short = _NUMBERED.sub(r"\1", name) if k in grouped else name
            if short not in yielded:
                yielded.add(short)
                yield cast("Column", short)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        return f"<{len(self.names)} columns of {self.time_s.size} samples>"

    @classmethod
    def read_csv(cls, path: str | os.PathLike[str]) -> Columns:
        """Columns of a file that `to_csv` or the program wrote."""
        with open(path, encoding="utf-8") as file:  # noqa: PTH123 - any path
            names = file.readline().strip().split(",")
            block = np.loadtxt(file, delimiter=",", ndmin=2).reshape(-1, len(names)).T.copy()
        return cls(_core.Columns(names[1:], block[0].tobytes(), block[1:].tobytes()))

    def __contains__(self, name: object) -> bool:
        return name == "time_s" or name in self._index or name in self._groups

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, self._parts()

    def _parts(self) -> tuple[tuple[str, ...], bytes, bytes]:
        return self.names, self.time_s.tobytes(), self._block.tobytes()

    def to_dict(self) -> dict[str, Floats]:
        """Every column by its full name, `time_s` first."""
        return {"time_s": self.time_s, **{name: self._block[k] for k, name in enumerate(self.names)}}

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame: a row a sample, `time_s` as its index."""
        pandas = wanted("pandas", "frames")
        frame = pandas.DataFrame(self._block.T, columns=list(self.names))
        frame.index = pandas.Index(self.time_s, name="time_s")
        return frame

    def to_polars(self) -> polars.DataFrame:
        """A polars DataFrame: a row a sample, `time_s` first."""
        polars = wanted("polars", "frames")
        return polars.DataFrame(self.to_dict())

    def to_xarray(self) -> xarray.Dataset:
        """A Dataset over `time_s` by the CF conventions, so that `.to_netcdf(path)` keeps units and long names.

        Numbered columns are one variable with a second dimension.
        """
        xarray = wanted("xarray", "frames")
        variables: dict[str, Any] = {}
        coordinates: dict[str, Any] = {"time_s": ("time_s", self.time_s, {"units": "s", "long_name": "time"})}
        for name in list(self)[1:]:
            values = self[name]
            dims = ["time_s"]
            if values.ndim == 2:
                of = name.split("_force")[0].split("_penetration")[0]
                dims.append(of if of != name else f"{name}_number")
                numbers = [number(full) for full in self.full_names(name)]
                described = {"units": "1", "long_name": f"number of the {quantity(of)}"}
                coordinates[dims[1]] = (dims[1], numbers, described)
            variables[name] = (dims, values, {"units": unit(name), "long_name": quantity(name)})
        attributes = {"Conventions": "CF-1.11", "source": f"pinwheel {_core.__version__}"}
        return xarray.Dataset(variables, coordinates, attributes)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the file that the program calls `courses.csv`: the same bytes, over none but an earlier one."""
        _core.write(path, _core.Columns(*self._parts()).csv(), "time_s,")


def _unpickled(names: tuple[str, ...], time: bytes, values: bytes) -> Columns:
    return Columns(_core.Columns(names, time, values))


def unit(name: str) -> str:
    """Returns the unit of a column or a figure.

    >>> unit("input_torque_n_m"), unit("output_angle_rad_3"), unit("wall_mm"), unit("efficiency")
    ('N m', 'rad', 'mm', '1')
    """
    return _core.named(_NUMBERED.sub(r"\1", name))[1] or "1"


def plot(columns: Columns, names: tuple[Column, ...], title: str, ax: Any) -> Any:
    """Draws columns over the time with matplotlib, into `ax` or a new figure; the first axes, all are in `.figure.axes`."""
    pyplot = wanted("matplotlib.pyplot", "plot")
    chosen = names or tuple(name for name in columns if name.endswith(("_n_m", "_force_n")))
    if not chosen:
        raise InputError("there is nothing to draw; name columns")
    if ax is None:
        shape = {"figsize": (8, 2.2 * len(chosen)), "squeeze": False, "layout": "constrained"}
        figure, axes = pyplot.subplots(len(chosen), 1, sharex=True, **shape)
        figure.suptitle(title, fontsize=9)
        axes = axes[:, 0]
        axes[-1].set_xlabel("time, s")
    else:
        axes = np.ravel(ax)
        if len(axes) != len(chosen):
            raise InputError(f"ax has {len(axes)} axes for {len(chosen)} columns; give one for each")
    for axis, name in zip(axes, chosen, strict=True):
        several = columns[name].ndim == 2
        label = [number(full) for full in columns.full_names(name)] if several else name
        axis.plot(columns.time_s, columns[name], linewidth=0.8, label=label)
        axis.set_ylabel(f"{quantity(name)}, {unit(name)}", fontsize=8)
        axis.grid(alpha=0.3)
        if several:
            axis.legend(title="number", fontsize=6, title_fontsize=6, loc="center left", bbox_to_anchor=(1.0, 0.5), ncols=2)
    return axes[0]


def quantity(name: str) -> str:
    """Returns the meaning of a column or a figure in words, without its unit.

    >>> quantity("input_torque_n_m"), quantity("external_sleeve_force_n_3")
    ('driver torque', 'ring pin force 3')
    """
    base, _, number = name.rpartition("_") if _NUMBERED.fullmatch(name) else (name, "", "")
    words = _core.named(base)[0]
    return f"{words[:1].lower()}{words[1:]} {number}".strip()
