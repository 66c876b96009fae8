#!/usr/bin/env bash
# MuJoCo 4.0.1: after mj_step with Euler, implicitfast or discrete, the derived data (site_xpos, efc_force, qacc, sensordata)
# belong to the start of the step. With RK4, only sensordata belongs to the start. site_xpos and efc_force belong to the last
# stage, which is at the end of the step. qacc belongs to neither. One would expect one instant for all data.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-core==4.0.1
"$folder/environment/bin/python" - <<'PYTHON'
import mujoco
import numpy as np

MODEL = """<mujoco><compiler angle="radian"/><option gravity="0 -9.81 0" timestep="0.01" integrator="{}" tolerance="1e-15"/>
<default><equality solref="0.05 1" solimp="0.9999 0.9999 0.001 0.5 1"/></default>
<worldbody><body name="rod"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint axis="0 0 1"/>
<inertial pos="1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/><site name="end" pos="1 0 0"/></body></worldbody>
<equality><connect body1="rod" anchor="0 0 0"/></equality>
<sensor><framepos objtype="site" objname="end"/></sensor></mujoco>"""


def instants(integrator):
    """For site_xpos, efc_force, qacc and sensordata after a step: the instant at which mj_forward returns the same."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(integrator))
    before, after, data = (mujoco.MjData(model) for _ in range(3))
    for _ in range(20):
        mujoco.mj_step(model, data)
    before.qpos[:], before.qvel[:] = data.qpos, data.qvel
    mujoco.mj_step(model, data)
    after.qpos[:], after.qvel[:] = data.qpos, data.qvel
    names = {}
    for state in before, after:
        mujoco.mj_forward(model, state)
    for name in "site_xpos", "efc_force", "qacc", "sensordata":
        values = [np.ravel(getattr(state, name)) for state in (before, data, after)]
        change = abs(values[2] - values[0]).max()
        start, end = (abs(values[1] - values[place]).max() / change for place in (0, 2))
        names[name] = "start" if start < 1e-3 else "end" if end < 1e-3 else "neither"
    return names


print(f"mujoco {mujoco.__version__}")
for integrator in "Euler", "implicitfast", "discrete", "RK4":
    result = instants(integrator)
    print(f"{integrator}: {result}")
    if integrator != "RK4":
        assert set(result.values()) == {"start"}, "the behaviour has changed"
assert list(result.values()) == ["end", "end", "neither", "start"], "the behaviour has changed"
PYTHON
