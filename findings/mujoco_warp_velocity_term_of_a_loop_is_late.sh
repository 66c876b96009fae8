#!/usr/bin/env bash
# MuJoCo Warp 4.0.0: the term with the bodies' velocities in a connect (J-dot v) is that of the evaluation before, since forward()
# makes the constraints before it computes the velocities. Two evaluations of one state differ; the second agrees with MuJoCo. One
# would guess that an evaluation depends on the state alone. It compiles kernels for some minutes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-warp==4.0.0 mujoco==4.0.0 warp-lang==1.19.0
WARP_CACHE_PATH="$folder/kernels" "$folder/environment/bin/python" - <<'PYTHON'
import mujoco
import mujoco_warp
import numpy as np
import warp

warp.config.log_level = warp.LOG_ERROR
BODY = '<body name="{0}" pos="{1} 0 0" euler="0 0 {3}"><joint axis="0 0 1"/><inertial pos="0.25 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>{2}</body>'
model = mujoco.MjModel.from_xml_string(
    f"""<mujoco><option gravity="0 0 0"/><worldbody>{BODY.format("crank", 0, BODY.format("coupler", 0.5, "", 60), 0)}
    {BODY.format("rocker", 1, "", 120)}</worldbody>
    <equality><connect body1="coupler" body2="rocker" anchor="0.5 0 0"/></equality></mujoco>"""
)
data = mujoco.MjData(model)
at_rest = mujoco.MjData(model)
mujoco.mj_forward(model, at_rest)
data.qvel[:] = 1.0, 2.0, 3.0
mujoco.mj_forward(model, data)
held, on_device = mujoco_warp.put_model(model), mujoco_warp.put_data(model, at_rest)
on_device.qvel.assign(data.qvel[None].astype(np.float32))
found = []
for _ in range(2):
    mujoco_warp.forward(held, on_device)
    found.append(on_device.qacc.numpy()[0].copy())
print(f"MuJoCo {mujoco.__version__}, MuJoCo Warp {mujoco_warp.__version__}")
print(f"accelerations by MuJoCo {data.qacc}")
print(f"by MuJoCo Warp, first evaluation {found[0]}, second evaluation of the same state {found[1]}")
size = np.abs(data.qacc).max()
first, second = (np.abs(each - data.qacc).max() / size for each in found)
assert first > 0.01 and second < 1e-4, "the behaviour has changed"
PYTHON
