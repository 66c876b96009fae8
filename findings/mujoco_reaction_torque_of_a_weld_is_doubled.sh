#!/usr/bin/env bash
# MuJoCo 4.0.1: the rotational rows of an equality `weld` measure half of the angle, since they use the vector part of a
# quaternion. So `efc_force` is twice the torque and `efc_pos` is half of the angle, also with torquescale 1. One would expect the
# torque, since the translational rows return the force. `qfrc_constraint` contains the torque.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-core==4.0.1
"$folder/environment/bin/python" - <<'PYTHON'
import mujoco

MODEL = """<mujoco><option gravity="0 0 0" integrator="implicit" tolerance="1e-14"/><worldbody><body name="bar">
<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint axis="0 0 1"/><geom type="box" size="0.5 0.1 0.1" mass="2"/>
</body></worldbody><equality><weld body1="bar" solref="0.01 1"/></equality></mujoco>"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qfrc_applied[:] = 3, 0, 7  # N, N, Nm
for _ in range(5000):
    mujoco.mj_step(model, data)
print(f"mujoco {mujoco.__version__}: a welded bar under 3 N and 7 Nm, at rest")
print(f"efc_force, x and last row: {data.efc_force[0]:+.4f} N, {data.efc_force[5]:+.4f}")
print(f"qfrc_constraint: {data.qfrc_constraint[0]:+.4f} N, {data.qfrc_constraint[2]:+.4f} Nm")
print(f"efc_pos, last row, by the angle: {data.efc_pos[5] / data.qpos[2]:.4f}")
assert abs(data.qfrc_constraint - (-3, 0, -7)).max() < 1e-4, "the weld does not hold the load"
assert abs(data.efc_force[0] + 3) < 1e-4 and abs(data.efc_force[5] + 14) < 1e-4, "the behaviour has changed"
PYTHON
