#!/usr/bin/env bash
# MuJoCo 4.0.1: the flag `sleep` stops a pendulum permanently at its turning point, away from equilibrium. One would expect that a
# body sleeps only if its velocity is zero and its forces are balanced. MuJoCo's rule uses velocities alone.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-core==4.0.1
"$folder/environment/bin/python" - <<'PYTHON'
import mujoco

MODEL = """<mujoco><option timestep="0.001"><flag sleep="{flag}"/></option><worldbody><body>
<joint axis="0 1 0"/><geom type="sphere" size="0.05" pos="0 0 -1" mass="1"/></body></worldbody></mujoco>"""


def last_angles(flag):
    model = mujoco.MjModel.from_xml_string(MODEL.format(flag=flag))
    data = mujoco.MjData(model)
    data.qpos[0] = 0.02
    angles = []
    while data.time < 10:
        mujoco.mj_step(model, data)
        if data.time > 7:
            angles.append(float(data.qpos[0]))
    return min(angles), max(angles)


awake, asleep = last_angles("disable"), last_angles("enable")
print(f"mujoco {mujoco.__version__}: a frictionless pendulum of 1 m from 0.02 rad, angles from 7 s to 10 s")
print("without sleep {:.4f} to {:.4f} rad; with sleep {:.4f} to {:.4f} rad".format(*awake, *asleep))
assert awake[1] - awake[0] > 0.039 and asleep[0] == asleep[1] and abs(asleep[0]) > 0.019, "the behaviour has changed"
PYTHON
