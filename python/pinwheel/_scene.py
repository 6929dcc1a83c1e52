"""Scenes: which gear, load, contact law and solver."""

from __future__ import annotations

import copy
import html
import json
import math
import os
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Unpack

from pinwheel import _core
from pinwheel._keys import COUNTS, Keys
from pinwheel.errors import Missing, SceneError

if TYPE_CHECKING:
    from pinwheel._engine import EngineLike
    from pinwheel._run import Run

TABLES = ("gear", "mass", "drive", "contact", "bearings", "structure", "temperature", "cranks", "limits", "solver", "output")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
# Name of a scene without a file; scenes of files have their full path.
_NO_FILE = "scene"


def toml_value(value: Any) -> str:
    """A Python value as TOML writes it; numpy's numbers and arrays too.

    >>> toml_value({"time_s": 0.3, "words": ["a", True]})
    '{ time_s = 0.3, words = ["a", true] }'
    """
    if hasattr(value, "tolist"):  # numpy: a scalar or an array
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, str | os.PathLike):
        return json.dumps(os.fspath(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        pairs = (f"{key if _BARE.fullmatch(key) else json.dumps(key)} = {toml_value(item)}" for key, item in value.items())
        return f"{{ {', '.join(pairs)} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    if isinstance(value, Decimal):
        return toml_value(float(value))
    raise TypeError(f"a scene holds numbers, texts, lists and tables, not {type(value).__name__}")


def settings(keys: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Keys, bare or dotted or in tables, as (full name, TOML value)."""
    pairs: list[tuple[str, str]] = []
    for name, value in keys.items():
        if isinstance(value, Mapping) and name.split(".")[0] in TABLES:
            pairs += settings({f"{name}.{key}": item for key, item in value.items()})
        else:
            full = _core.key(name)
            if isinstance(value, float) and full in COUNTS and value.is_integer():
                value = int(value)
            try:
                pairs.append((full, toml_value(value)))
            except TypeError as error:
                raise TypeError(f"`{name}`: {error}") from None
    return pairs


class Scene:
    """Everything a run depends on: gear, masses, drive, contact, solver. All values are SI, as the names of keys say.

    `source` is a preset (`"paper"`), a scene file, or a dict of tables; keywords set keys by their last part
    (`backlash_m`), a dict after the source in full (`{"gear.backlash_m": 6e-4}`). What is left out follows from the rest or
    is a usual value. A scene is checked when it is made and never changes; `with_` gives another.

    >>> import pinwheel
    >>> s = pinwheel.Scene("paper", backlash_m=6e-4)
    >>> s["gear.backlash_m"], s["external_sleeves"]
    (0.0006, 16)
    >>> s == pinwheel.Scene("paper").with_(backlash_m=6e-4)
    True
    >>> pinwheel.Scene("paper", backlsh_m=0.0)
    Traceback (most recent call last):
    ...
    pinwheel_engines.errors.SceneError: `backlsh_m` is no key of a scene; did you mean `backlash_m`?

    Raises `SceneError` with the key and the remedy.
    """

    __slots__ = ("_inner", "_tables", "_toml")
    _inner: _core.Scene
    _tables: dict[str, Any] | None
    _toml: str

    def __init__(
        self,
        source: str | os.PathLike[str] | Mapping[str, Any] | None = None,
        changes: Mapping[str, Any] | None = None,
        /,
        **keys: Unpack[Keys],
    ) -> None:
        sets = settings({**(changes or {}), **keys})
        if source is None or isinstance(source, Mapping):
            written = settings(source or {})
            lines = [f"{key} = {value}" for key, value in written]
            # The text of a scene must name a base.
            lines += [f"{key} = {value}" for key, value in sets if key == "base"]
            core = _core.Scene(_NO_FILE, "\n".join(lines), [pair for pair in sets if pair[0] != "base"])
        else:
            core = _core.Scene.load(os.fspath(source), sets)
        self._set(core)

    def _set(self, core: _core.Scene) -> None:
        object.__setattr__(self, "_inner", core)
        object.__setattr__(self, "_toml", core.to_toml())
        object.__setattr__(self, "_tables", None)

    @classmethod
    def _of(cls, core: _core.Scene) -> Scene:
        made = cls.__new__(cls)
        made._set(core)
        return made

    @classmethod
    def from_toml(cls, text: str) -> Scene:
        """A scene from the text of a scene file."""
        return cls._of(_core.Scene(_NO_FILE, text, []))

    def with_(self, changes: Mapping[str, Any] | None = None, /, **keys: Unpack[Keys]) -> Scene:
        """Returns a copy of the scene with other values of some keys, derived and checked anew."""
        return Scene._of(self._inner.changed(settings({**(changes or {}), **keys})))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a scene file with every key in it, over none but an earlier scene."""
        _core.write(path, self._toml.encode(), "[gear]")

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a scene never changes; scene.with_(...) gives another")

    def __delattr__(self, name: str) -> None:
        raise AttributeError("a scene never changes; scene.with_(...) gives another")

    @property
    def name(self) -> str:
        """Name shown in results."""
        return str(self.to_dict().get("name", ""))

    def to_toml(self) -> str:
        """Every key written out, as a scene file."""
        return self._toml

    def to_dict(self) -> dict[str, Any]:
        """Every key, as tables."""
        return copy.deepcopy(self._parsed())

    def _parsed(self) -> dict[str, Any]:
        """Every key, read once."""
        if self._tables is None:
            object.__setattr__(self, "_tables", tomllib.loads(self._toml))
        assert self._tables is not None
        return self._tables

    def _ipython_key_completions_(self) -> list[str]:
        return [*self.keys(), *(key.rpartition(".")[2] for key in self.keys())]

    def __getitem__(self, key: str) -> Any:
        value: Any = self._parsed()
        full = key if key in (*TABLES, "name", "description") else _core.key(key)
        try:
            for part in full.split("."):
                value = value[part]
        except KeyError:
            raise Missing(f"{key} has no value in this scene") from None
        return copy.deepcopy(value) if isinstance(value, dict | list) else value

    def __contains__(self, key: object) -> bool:
        try:
            self[str(key)]
        except (KeyError, SceneError):
            return False
        return True

    def __iter__(self) -> Iterator[str]:
        return self.keys()

    def keys(self) -> Iterator[str]:
        """Full names of all keys that have a value."""

        def leaves(prefix: str, table: Mapping[str, Any]) -> Iterator[str]:
            for key, value in table.items():
                if isinstance(value, dict):
                    yield from leaves(f"{prefix}{key}.", value)
                else:
                    yield f"{prefix}{key}"

        return leaves("", self._parsed())

    @property
    def assumed(self) -> dict[str, str]:
        """Keys without a stated value, and the source of each value."""
        return {key: f"{value}: {why}" for key, value, why in self._inner.origins()}

    def plot(self, ax: Any = None) -> Any:
        """Draws the gear at its start with matplotlib, lengths in mm, into `ax` or a new figure; the axes."""
        from pinwheel._drawing import draw

        return draw(self, ax)

    def run(
        self,
        engine: EngineLike = "native",
        *,
        check: bool = True,
        progress: bool | Callable[[int, int, str, float, float], object] | None = None,
    ) -> Run:
        """Runs the scene on an engine; see `pinwheel.run`."""
        from pinwheel._run import run

        return run(self, engine, check=check, progress=progress)

    def __eq__(self, other: object) -> bool:
        return self._toml == other._toml if isinstance(other, Scene) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._toml)

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (*self._inner.spec(), self._toml)

    def __repr__(self) -> str:
        name, text, sets = self._inner.spec()
        short = [f"{_short(key)}={value}" for key, value in sets]
        if name == _NO_FILE:
            return f"Scene({', '.join([*text.splitlines(), *short])})"
        return f"Scene({', '.join([repr(name), *short])})"

    def _repr_html_(self) -> str:
        assumed = {key for key, _, _ in self._inner.origins()}
        rows = []
        for key in self.keys():
            value = html.escape(repr(self[key]) if key not in ("name", "description") else str(self[key]))
            note = "derived" if key in assumed else ""
            rows.append(f"<tr><td>{html.escape(key)}</td><td>{value}</td><td>{note}</td></tr>")
        return f"<details><summary>{html.escape(repr(self))}</summary><table>{''.join(rows)}</table></details>"


def _short(key: str) -> str:
    """Returns the shortest unambiguous name of a key."""
    last = key.rsplit(".", 1)[-1]
    try:
        return last if _core.key(last) == key else key
    except ValueError:
        return key


def _unpickled(name: str, text: str, sets: list[tuple[str, str]], toml: str) -> Scene:
    """Restores a pickled scene without the files that it was made from."""
    try:
        scene = Scene._of(_core.Scene(name, text, sets))
        if scene.to_toml() == toml:
            return scene
    except (ValueError, OSError):
        pass
    return Scene.from_toml(toml)
