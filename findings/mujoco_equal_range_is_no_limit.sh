#!/usr/bin/env bash
# MuJoCo 4.0.1: a joint with range="10 10" and no `limited` has no limit, and MuJoCo prints no warning. One would expect a locked
# joint, or the error that limited="true" gives.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-core==4.0.1
"$folder/environment/bin/python" - <<'PYTHON'
import mujoco

MODEL = """<mujoco><worldbody><body><joint axis="0 1 0" {limited} range="{range}"/>
<geom type="sphere" size="0.1" pos="0.5 0 0"/></body></worldbody></mujoco>"""


def is_limited(limited, bounds):
    return bool(mujoco.MjModel.from_xml_string(MODEL.format(limited=limited, range=bounds)).jnt_limited[0])


narrow, equal = is_limited("", "9.999 10.001"), is_limited("", "10 10")
try:
    named = str(is_limited('limited="true"', "10 10"))
except ValueError as error:
    named = str(error).splitlines()[0]
print(f"mujoco {mujoco.__version__}: range 9.999 10.001 limits: {narrow}; range 10 10 limits: {equal}")
print(f"range 10 10 with limited: {named}")
assert narrow and not equal and "smaller" in named, "the behaviour has changed"
PYTHON
