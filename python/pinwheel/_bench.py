"""Cost of accuracy: work-precision studies."""

from __future__ import annotations

import csv
import html
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pinwheel import _core
from pinwheel._columns import wanted
from pinwheel._engine import EngineLike, several
from pinwheel._page import Paged, plain
from pinwheel._progress import Progress, reporting
from pinwheel._scene import Scene

if TYPE_CHECKING:
    import pandas


class Bench(Paged):
    """Error against cost of every engine, method and step.

    Attributes:
        rows: A row a run, as the program's `bench.csv`: None where there is no value

    """

    def __init__(self, core: _core.Benched) -> None:
        self._page, self._text = core.page, plain(core.text())
        self.rows: list[dict[str, Any]] = [
            {key: _number(value) for key, value in row.items()}
            for row in csv.DictReader(io.StringIO(bytes(core.csv()).decode()))
        ]

    _called = "bench"

    def to_pandas(self) -> pandas.DataFrame:
        """The rows as a DataFrame."""
        return wanted("pandas", "frames").DataFrame(self.rows)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<Bench: {len(self.rows)} runs>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(str(self))}</pre>"


def _number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text or None


def bench(
    scene: Scene | str,
    engines: Sequence[EngineLike] | EngineLike = (),
    *,
    target: float = 1e-3,
    methods: Sequence[str] = (),
    repeats: int = 3,
    longest_s: float = 10.0,
    progress: bool | Progress | None = None,
) -> Bench:
    """Runs a scene with ever smaller steps and tolerances and measures error and cost, engine by engine.

    `target`: the error, relative L2, at which costs are compared; `methods`: integrators of the native solver, all without;
    `repeats`: timings of each run; `longest_s`: of one run of a foreign engine.
    """
    made = scene if isinstance(scene, Scene) else Scene(scene)
    with reporting(progress, "bench") as report:
        return Bench(_core.bench(made._inner, several(engines), (target, repeats, longest_s), list(methods), report))
