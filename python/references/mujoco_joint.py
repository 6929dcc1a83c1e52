"""A gear's joint in MuJoCo, driven and loaded like the gear.

    python mujoco_joint.py joint_mujoco.xml courses.csv

The table has the columns time_s, input_angle_rad, input_rate_rad_s, load_n_m and output_angle_rad of the gear, the load
counter-clockwise on the output. Input and load are linear between its rows. Prints, as JSON, the output angles of the joint
at these times and MuJoCo's version.
"""

from __future__ import annotations

import json
import sys

import mujoco
import numpy as np


def follow(model_file: str, courses_file: str) -> list[float]:
    """Returns the output angles of the joint, rad."""
    model = mujoco.MjModel.from_xml_path(model_file)
    data = mujoco.MjData(model)
    time, angle, rate, load, output = np.loadtxt(courses_file, delimiter=",", skiprows=1).T
    names = [model.joint(joint).name for joint in range(model.njnt)]
    # Both joints are hinges: as many positions as velocities.
    inner, outer = (next(k for k, name in enumerate(names) if name.endswith(end)) for end in ("input", "output"))
    sample = time[1] - time[0]
    steps = max(1, int(np.ceil(sample / model.opt.timestep)))
    model.opt.timestep = sample / steps
    data.qpos[outer], data.qvel[outer] = output[0], (output[1] - output[0]) / sample
    angles = [float(output[0])]
    for k in range(len(time) - 1):
        for step in range(steps):
            share = step / steps
            data.qpos[inner] = angle[k] + share * (angle[k + 1] - angle[k])
            data.qvel[inner] = rate[k]
            data.qfrc_applied[outer] = load[k] + share * (load[k + 1] - load[k])
            mujoco.mj_step(model, data)
        angles.append(float(data.qpos[outer]))
    return angles


if __name__ == "__main__":
    angles = follow(sys.argv[1], sys.argv[2])
    json.dump({"version": mujoco.__version__, "output_angle_rad": angles}, sys.stdout)
