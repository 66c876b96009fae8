#!/usr/bin/env bash
# Pinocchio 4.1.0: buildModelFromMJCF reads the first body of <worldbody> with its children and ignores all other bodies of the
# world, without an error or a warning. A four-bar linkage of two trees becomes a double pendulum. One would expect a model with
# all joints, since the universe joint may have several children.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check pin==4.1.0
"$folder/environment/bin/python" - <<'PYTHON'
import tempfile
from pathlib import Path

import pinocchio

BODY = '<body name="{0}" pos="{1} 0 0"><joint name="{0}" axis="0 0 1"/><inertial pos="0.2 0 0" mass="1" diaginertia="1 1 1"/>{2}</body>'
CRANK = BODY.format("crank", 0, BODY.format("coupler", 0.3, ""))
ROCKER = BODY.format("rocker", 0.7, "")


def joints(bodies):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.xml"
        file.write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
        return list(pinocchio.buildModelFromMJCF(str(file)).names)[1:]


print(f"pinocchio {pinocchio.__version__}")
print(f"crank and coupler, then rocker: joints {joints(CRANK + ROCKER)}")
print(f"rocker, then crank and coupler: joints {joints(ROCKER + CRANK)}")
assert joints(CRANK + ROCKER) == ["crank", "coupler"] and joints(ROCKER + CRANK) == ["rocker"], "the behaviour has changed"
PYTHON
