"""Writes `pinwheel/_keys.py`, the types of a scene's keys, from the program's table of keys: `python -P make_keys.py`,
where the package is installed.
"""

import json
import re
from pathlib import Path

from pinwheel import _core, gear
from pinwheel._scene import TABLES

HEAD = '''"""Types of a scene's keys; written by `python/make_keys.py` from the program's table of keys."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
'''


def annotation(schema: dict) -> str:
    """Returns the type of a key's values."""
    if "enum" in schema:
        return f"Literal[{', '.join(json.dumps(name) for name in schema['enum'])}]"
    kinds = schema["type"]
    if isinstance(kinds, list):
        return "str | Sequence[str]"
    item = schema.get("items", {})
    array = "Sequence[Mapping[str, Any]]" if item.get("type") == "object" else "Sequence[float] | npt.NDArray[np.float64]"
    return {"number": "float", "integer": "int", "boolean": "bool", "string": "str", "array": array}[kinds]


def leaves(schema: dict, prefix: str = "") -> dict[str, dict]:
    """Returns every key in full, with its schema."""
    keys = {}
    for name, inner in schema["properties"].items():
        full = f"{prefix}{name}"
        if full == "uncertain":
            continue
        keys.update(leaves(inner, f"{full}.") if "properties" in inner else {full: inner})
    return keys


def columns() -> list[str]:
    """Returns the column names of a run of a gear of usual size: pins and pairs by their shared names, as single ones
    would be too many to read in a message.
    """
    large = gear(ratio=39, pin_circle_diameter_mm=104, torque_n_m=200, speed_rpm=1500, wheels=3, output_pins=16)
    run = large.with_(duration_s=1e-5, sample_s=1e-5, channels=["*"]).run("native", check=False)
    single = re.compile(r"wheel_\d_.*_\d+|.*_pin_force.*_\d+")
    return list(dict.fromkeys([*run, *(name for name in run.columns.names if not single.fullmatch(name))]))


def text() -> str:
    """Returns the text of the module."""
    keys = leaves(json.loads(_core.schema()))
    bare: dict[str, str] = {}
    for full in keys:
        last = full.rpartition(".")[2]
        if last in TABLES:  # the table goes first
            continue
        try:
            bare[last] = _core.key(last)
        except ValueError:  # it stands for several
            continue
    counts = sorted(full for full, schema in keys.items() if schema.get("type") == "integer")
    lines = [HEAD, "# Keys with integer values.", "COUNTS = frozenset("]
    lines += ["    {", *(f'        "{name}",' for name in counts), "    }", ")", ""]
    lines += ["", "class Keys(TypedDict, total=False):", '    """Keys by their last part, and tables."""', ""]
    lines += [f"    {table}: Mapping[str, Any]" for table in TABLES]
    for name, full in bare.items():
        about = keys[full].get("description", "").replace("\\", "\\\\").replace('"', "'")
        lines += [f"    {name}: {annotation(keys[full])}", f'    """{about}"""']
    lines += ["", "", "Axis: TypeAlias = Sequence[Any] | Mapping[str, Any] | Any"]
    lines += ["# Keys that vary, by their last part or in full."]
    every = [*bare, *(full for full in keys if "." in full)]
    lines += ["Vary = TypedDict(", '    "Vary",', "    {"]
    lines += [f"        {json.dumps(name)}: Axis," for name in every]
    lines += ["    },", "    total=False,", ")", ""]
    lines += ["# Columns of a run, and channels; of 40 ring and 16 output pins and 3 discs."]
    lines += ["Column: TypeAlias = Literal["]
    lines += [*(f"    {json.dumps(name)}," for name in columns()), "]", ""]
    return "\n".join(lines)


if __name__ == "__main__":
    Path(__file__).with_name("pinwheel").joinpath("_keys.py").write_text(text(), encoding="utf-8")
