"""The mechanism as MJCF: a tree of hinges, one a body, shared by both tracks."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
import numpy.typing as npt

from pinwheel_engines.errors import Unsupported
from pinwheel_engines.layout import INPUT, Kinematics
from pinwheel_engines.scene import Scene


def tree_xml(scene: Scene, armature_kg_m2: float, content: Callable[[int], str] = lambda _body: "") -> str:
    """Bodies b0, b1, ... with hinges j0, j1, ... in the order of `layout`; `content` adds geoms and sites to a body.

    Discs that float slide along x0, x1, ... and y0, y1, ... beside.

    The input's hinge carries `armature_kg_m2`, which makes it the driver. Only moments about z count in the plane; the
    other two are set alike because MuJoCo wants a possible solid.

    Raises Unsupported for parts that are too light for MuJoCo.
    """
    kinematics = Kinematics(scene.gear, scene.floats)
    layout, parts = kinematics.layout, scene.mass.of_bodies(scene.gear)
    least = min(min(part.mass_kg, part.moment_kg_m2) for part in parts)
    if not least > mujoco.mjMINVAL:
        limit = f"MuJoCo takes only more than {mujoco.mjMINVAL:.0e}"
        raise Unsupported("mujoco", f"a part has {least:.1e} kg or kg m^2, and {limit}")
    floating = range(layout.bodies)[layout.wheel_bodies] if scene.floats else range(0)

    def body(index: int) -> str:
        at, part = kinematics.offsets[index], parts[index]
        j = repr(part.moment_kg_m2)
        armature = f' armature="{armature_kg_m2!r}"' if index == INPUT else ""
        inner = "".join(body(child) for child in range(layout.bodies) if kinematics.carriers[child] == index)
        slides = ""
        if index in floating:
            at = 0j
            for axis, along in (("x", "1 0 0"), ("y", "0 1 0")):
                slides += f'<joint name="{axis}{index - floating[0]}" type="slide" axis="{along}"/>'
        return (
            f'<body name="b{index}" pos="{float(at.real)!r} {float(at.imag)!r} 0">'
            f'<inertial pos="0 0 0" mass="{part.mass_kg!r}" diaginertia="{j} {j} {j}"/>{slides}'
            f'<joint name="j{index}" type="hinge" axis="0 0 1"{armature}/>{content(index)}{inner}</body>\n'
        )

    return "".join(body(index) for index in range(layout.bodies) if kinematics.carriers[index] < 0)


def coordinates(kinematics: Kinematics, model: mujoco.MjModel) -> npt.NDArray[np.intp]:
    """Index of every body's hinge in qpos and qvel."""
    return np.array([model.joint(f"j{index}").qposadr[0] for index in range(kinematics.layout.bodies)], dtype=np.intp)


def slides(scene: Scene, model: mujoco.MjModel) -> npt.NDArray[np.intp]:
    """Index of the slides of every disc in qpos and qvel, shape (discs, 2); none where no disc floats."""
    wheels = range(scene.gear.wheels if scene.floats else 0)
    addresses = [[model.joint(f"{axis}{wheel}").qposadr[0] for axis in "xy"] for wheel in wheels]
    return np.array(addresses, dtype=np.intp).reshape(-1, 2)
