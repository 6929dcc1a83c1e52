"""Model, assumptions and expected figures of a scene, without a run."""

from __future__ import annotations

import html
import json
from typing import Any

from pinwheel import _core
from pinwheel._page import plain
from pinwheel._scene import Scene


class Explanation:
    """Explanation of a scene: `str(...)` for people, `data` for programs."""

    def __init__(self, data: dict[str, Any], text: str) -> None:
        self.data = data
        self._text = text

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<Explanation of {self.data['scene']['name']}>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self._text)}</pre>"


def explain(scene: Scene | str) -> Explanation:
    """Explains the modelled and the omitted effects, the derived dimensions and the assumed values of a scene.

    >>> explain("paper").data["derived"]["ratio"]
    15.0
    """
    made = scene if isinstance(scene, Scene) else Scene(scene)
    data, text = _core.explain(made._inner)
    return Explanation(json.loads(data), plain(text))
