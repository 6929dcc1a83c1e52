"""Contact laws as functions of arrays."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np
import numpy.typing as npt

from pinwheel import _core
from pinwheel._keys import Keys
from pinwheel._scene import Scene

Floats = npt.NDArray[np.float64]


class Law:
    """A normal contact law: the force, N, from stiffness, penetration and its rate, on arrays that broadcast.

    Parameters are the keys of `contact` in a scene, the paper's where left out.

    >>> law = Law("paper", damping_n_s_m=0.0)
    >>> law(9e7, [-1e-6, 2e-5])
    array([0.        , 8.04984472])
    """

    def __init__(self, name: str = "paper", scene: Scene | None = None, /, **keys: Unpack[Keys]) -> None:
        base = scene if scene is not None else Scene("paper")
        self.name = name
        self.scene = base.with_(**keys) if keys else base
        self._core = _core.Law(name, self.scene._inner)

    def __call__(
        self, stiffness_n_m15: npt.ArrayLike, penetration_m: npt.ArrayLike, rate_m_s: npt.ArrayLike = 0.0
    ) -> Floats:
        """Forces, N, in the shape that the arguments broadcast to; 0 where the penetration is not above 0.

        `stiffness_n_m15`: K of Hertz' force K depth^1.5; `rate_m_s`: growth of the penetration, positive while bodies
        approach.
        """
        arrays = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (stiffness_n_m15, penetration_m, rate_m_s)))
        stiffness, depth, rate = (np.ascontiguousarray(x).reshape(-1) for x in arrays)
        out = np.empty_like(stiffness)
        self._core.forces(stiffness, depth, rate, out)
        return out.reshape(arrays[0].shape)

    def __reduce__(self) -> tuple[Any, ...]:
        return Law, (self.name, self.scene)

    def __repr__(self) -> str:
        return f"Law({self.name!r})"


@dataclass(frozen=True)
class LawInfo:
    """A contact law that scenes can name.

    Attributes:
        keys: Keys of a scene that it reads besides those that every law does

    """

    name: str
    summary: str
    formula: str
    source: str
    keys: tuple[str, ...]


def laws() -> list[LawInfo]:
    """The contact laws there are.

    >>> [law.name for law in laws()][:2]
    ['paper', 'paper-conservative']
    """
    return [
        LawInfo(law["name"], law["summary"], law["formula"], law["source"], tuple(law["keys"]))
        for law in json.loads(_core.laws())
    ]
