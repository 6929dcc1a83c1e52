"""The gear at its start, drawn with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pinwheel._columns import wanted
from pinwheel_engines.geometry import Epitrochoid
from pinwheel_engines.layout import Kinematics, hole_centres
from pinwheel_engines.scene import Scene as Tables

if TYPE_CHECKING:
    from pinwheel._scene import Scene

POINTS_PER_LOBE = 60


def draw(scene: Scene, ax: Any) -> Any:
    """Sleeves and discs with their holes; the axes."""
    pyplot = wanted("matplotlib.pyplot", "plot")
    patches = wanted("matplotlib.patches", "plot")
    tables = Tables.from_toml(scene.to_toml())
    gear, kinematics = tables.gear, Kinematics(tables.gear)
    layout = kinematics.layout
    angles, rates = kinematics.ideal(tables)
    states = kinematics.states(angles, rates)
    centres = 1e3 * (states[:, 0] + 1j * states[:, 1])
    if ax is None:
        _, ax = pyplot.subplots(figsize=(5, 5), layout="constrained")

    def circles(at: Any, radius_m: float, **style: Any) -> None:
        for centre in at:
            ax.add_patch(patches.Circle((centre.real, centre.imag), 1e3 * radius_m, **style))

    curve = Epitrochoid.of(gear)
    turn = np.linspace(0.0, 2.0 * np.pi, POINTS_PER_LOBE * gear.lobes)
    edge = 1e3 * (curve.point(turn) - gear.edge_offset_m * curve.normal(turn))
    turned, at = np.exp(1j * angles[layout.wheel_bodies]), centres[layout.wheel_bodies]
    for wheel, holes in enumerate(1e3 * hole_centres(gear)):
        placed = at[wheel] + turned[wheel] * edge
        ax.plot(placed.real, placed.imag, color=f"C{wheel}", linewidth=1.0, label=f"disc {wheel}")
        circles(at[wheel] + turned[wheel] * holes, gear.hole_radius_m, fill=False, color=f"C{wheel}")
    circles(centres[layout.external_bodies], gear.external_sleeve_radius_m, color="0.6")
    circles(centres[layout.internal_bodies], gear.internal_sleeve_radius_m, color="0.8")
    ax.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
    ax.set_title(f"{scene['name']}, ratio {gear.lobes}", fontsize=9)
    ax.legend(fontsize=7, loc="upper right")
    return ax
