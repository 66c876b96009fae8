#!/usr/bin/env bash
# MuJoCo 4.0.1: the sensor `framelinacc` of a site at rest returns +9.81 m/s2 upwards, as an accelerometer does. Its documentation
# calls it the 3D linear acceleration of the frame in global coordinates. One would expect the derivative of `framelinvel`, which
# is zero here.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-core==4.0.1
"$folder/environment/bin/python" - <<'PYTHON'
import mujoco

MODEL = """<mujoco><option gravity="0 0 -9.81"/><worldbody><site name="fixed" pos="1 0 0"/>
<body><joint axis="0 1 0"/><geom type="sphere" size="0.1" pos="0 0 -1"/><site name="hanging" pos="0 0 -1"/></body></worldbody>
<sensor><framelinacc objtype="site" objname="fixed"/><framelinacc objtype="site" objname="hanging"/>
<framelinvel objtype="site" objname="hanging"/></sensor></mujoco>"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
for _ in range(500):
    mujoco.mj_step(model, data)
fixed, hanging, velocity = data.sensordata.reshape(3, 3)
print(f"mujoco {mujoco.__version__}: a site of the world has framelinacc {fixed}, a body hanging at rest {hanging}")
print(f"framelinvel of the hanging body after 500 steps: {velocity}")
assert abs(velocity).max() < 1e-12, "the body moves"
assert abs(fixed - (0, 0, 9.81)).max() < 1e-9 and abs(hanging - (0, 0, 9.81)).max() < 1e-9, "the behaviour has changed"
PYTHON
