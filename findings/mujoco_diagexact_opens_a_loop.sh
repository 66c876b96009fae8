#!/usr/bin/env bash
# MuJoCo 4.0.1: the flag `diagexact` increases the gap of the `connect` in a stiff closed loop. The flag replaces an approximate
# diagonal of the constraint-space inertia by the exact one, so one would expect a smaller error. The compliance of a row is
# proportional to this diagonal, and the exact diagonal is larger in this loop.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-core==4.0.1
"$folder/environment/bin/python" - <<'PYTHON'
import mujoco

MODEL = """<mujoco><option timestep="0.001" integrator="RK4" tolerance="1e-15">
<flag diagexact="{flag}" contact="disable"/></option>
<default><equality solref="0.005 1" solimp="0.9999 0.9999 0.001 0.5 1"/></default><worldbody>
<body><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 0.4" size="0.01" mass="0.4"/>
  <body name="coupler" pos="0 0 0.4"><joint axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 0.4 0 0.4" size="0.01" mass="0.57"/></body></body>
<body name="rocker" pos="1.2 0 0"><joint axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 -0.8 0 0.8" size="0.01" mass="1.13"/></body>
</worldbody><equality><connect body1="coupler" body2="rocker" anchor="0.4 0 0.4"/></equality></mujoco>"""


def largest_gap(flag):
    model = mujoco.MjModel.from_xml_string(MODEL.format(flag=flag))
    data, largest = mujoco.MjData(model), 0.0
    while data.time < 0.5:
        mujoco.mj_step(model, data)
        largest = max(largest, float(abs(data.efc_pos).max()))
    return largest


usual, exact = largest_gap("disable"), largest_gap("enable")
print(f"mujoco {mujoco.__version__}: largest gap of a four-bar's loop in 0.5 s: {usual:.3g} m, with diagexact {exact:.3g} m")
assert exact > 1.4 * usual, "the behaviour has changed"
PYTHON
