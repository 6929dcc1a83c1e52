"""One scene on several engines, compared pair by pair."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from pinwheel import _core
from pinwheel._columns import Columns, near, wanted
from pinwheel._engine import EngineLike, number_of, several
from pinwheel._page import Paged, plain
from pinwheel._progress import Progress, reporting
from pinwheel._scene import Scene
from pinwheel.errors import Missing

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Verdict:
    """Verdict on one quantity of two engines in one window of time.

    Attributes:
        track: What the two have in common
        distance: Relative L2 of the difference, where it could be compared
        uncertainty: U = u_a + u_b, the numerical uncertainty of both, relative
        reason: Reason of the verdict, if it has one

    """

    a: str
    b: str
    track: str
    window: str
    quantity: str
    verdict: Literal["agree", "differ", "inconclusive", "not-compared"]
    distance: float | None
    uncertainty: float | None
    reason: str


class Comparison(Paged, Mapping[EngineLike, Columns]):
    """A comparison: verdicts, the runs behind them, and the page.

    Attributes:
        data: The program's `summary.json`
        runs: Time series of every engine that ran
        verdicts: A verdict a pair of engines, window and quantity

    """

    def __init__(self, scene: Scene, core: _core.Compared) -> None:
        self.scene = scene
        self._passed = core.passed()
        self._page, self._text, self._details = core.page, plain(core.text()), plain(core.details())
        self.data: dict[str, Any] = json.loads(core.json())
        self.runs: dict[str, Columns] = {name: Columns(columns) for name, columns in core.time_series()}
        self.verdicts: tuple[Verdict, ...] = tuple(
            _verdict(pair, entry) for pair in self.data["pairs"] for entry in pair["entries"]
        )

    # Equality of arrays is an array.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    _called = "compare"

    @property
    def passed(self) -> bool:
        """True if the program would end with 0.

        Something was shown of every engine and record of yours, or two engines agree where there is none. Nothing
        differs, and every engine that you named finished. `findings` says what was shown.
        """
        return self._passed

    @property
    def findings(self) -> tuple[str, ...]:
        """A line for each engine, record and limit of yours, or for all engines: agrees, differs, or nothing shown."""
        return tuple(plain(finding["line"]) for finding in self.data["findings"])

    @property
    def engines(self) -> dict[str, str]:
        """Returns the ending of every engine's run.

        `finished`, `diverged`, `unsupported`, `absent`, `failed` or `timed-out`.
        """
        return {engine["name"]: engine["status"]["state"] for engine in self.data["engines"]}

    def __getitem__(self, engine: EngineLike) -> Columns:
        """Time series of an engine, by its name or its object."""
        name = engine if isinstance(engine, str) else engine.name
        full = name.replace("_", "-")
        if name == "native" and name not in self.runs:
            full = f"native-{self.scene['solver.formulation']}"
        for known in (name, full):
            if known in self.runs:
                return self.runs[known]
        raise Missing(f"no time series of `{name}`; {near(name, self.runs, self.runs)}")

    def __iter__(self) -> Iterator[EngineLike]:
        return iter(self.runs)

    def __len__(self) -> int:
        return len(self.runs)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.runs)

    def to_pandas(self) -> pandas.DataFrame:
        """The verdicts as a DataFrame: a row a pair of engines, window and quantity."""
        return wanted("pandas", "frames").DataFrame([vars(verdict) for verdict in self.verdicts])

    def time_series_to_pandas(self) -> pandas.DataFrame:
        """Time series of all engines as a tidy DataFrame: a row an engine, time and column, with its value in SI."""
        pandas = wanted("pandas", "frames")
        frames = {engine: columns.to_pandas() for engine, columns in self.runs.items()}
        joined = pandas.concat(frames, names=["engine"]).reset_index()
        return joined.melt(["engine", "time_s"], var_name="column").dropna(ignore_index=True)

    def details(self) -> str:
        """Figures of every engine and the verdict of every pair, as text."""
        return self._details

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        counts = {word: count for word, count in self.data["counts"].items() if count and word != "inconclusive_actionable"}
        counted = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in counts.items()) or "nothing compared"
        return f"<Comparison of {self.scene.name} in {len(self.engines)} engines: {'; '.join(self.findings)}; {counted}>"

    def _repr_html_(self) -> str:
        rows = []
        for v in self.verdicts:
            numbers = ("" if x is None else f"{x:.2g}" for x in (v.distance, v.uncertainty))
            rows.append((v.reason, (v.a, v.b, v.window, v.quantity, v.verdict.replace("-", " "), *numbers)))
        return self._table(("a", "b", "window", "quantity", "verdict", "D", "U"), rows)


def _verdict(pair: dict[str, Any], entry: dict[str, Any]) -> Verdict:
    parts = [entry[side] for side in ("u_a", "u_b")]
    return Verdict(
        a=pair["a"],
        b=pair["b"],
        track=pair["track"],
        window=entry["window"],
        quantity=entry["quantity"],
        verdict=entry["verdict"],
        distance=(entry["metrics"] or {}).get("relative_l2"),
        uncertainty=None if None in parts else sum(parts),
        reason=str(entry.get("reason", "")),
    )


def compare(
    scene: Scene | str,
    engines: Sequence[EngineLike] | EngineLike = (),
    *,
    against: Sequence[tuple[str | os.PathLike[str], str | os.PathLike[str]]] = (),
    longest_s: float = 30.0,
    resolution: float = 0.01,
    jobs: int | None = None,
    fresh: bool = False,
    progress: bool | Progress | None = None,
) -> Comparison:
    """Runs a scene on several engines and compares every pair; without names on all that this Python has.

    Each engine also runs at coarser settings, which shows its numerical uncertainty; see docs/verdicts.md. An engine of
    yours that raises ends in `EngineFailed`, with its exception as the cause and the comparison as `comparison`.
    How every other engine ended is its status in the result.

    `against`: measured data or another program's, as (file, map); the map says which column is what, with its
    uncertainty (docs/foreign-data.md). `longest_s`: CPU time after which an engine is refined no further; `resolution`:
    the largest uncertainty of a pair, relative, that still counts as resolved. `jobs`: engines at a time, one a core by
    itself; those in Python take turns. Runs of other projects' engines are kept for the next comparison, the program's
    too; `fresh` makes them anew.

    >>> c = compare(Scene("paper", duration_s=0.01, step_s=2e-6), ["native-reduced", "native-lagrange"])
    >>> c.passed, {v.verdict for v in c.verdicts} <= {"agree"}
    (True, True)
    """
    made = scene if isinstance(scene, Scene) else Scene(scene)
    with reporting(progress, "compare") as report:
        files = [(os.fspath(file), os.fspath(table)) for file, table in against]
        core = _core.compare(made._inner, several(engines), files, (longest_s, resolution), (number_of(jobs), fresh), report)
    for line in core.messages():
        warnings.warn(line, stacklevel=2)
    comparison = Comparison(made, core)
    failure = core.failure()
    if failure is not None:
        failure.comparison = comparison  # type: ignore[attr-defined]
        raise failure
    return comparison
