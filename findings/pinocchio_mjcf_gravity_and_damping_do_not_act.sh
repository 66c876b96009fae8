#!/usr/bin/env bash
# Pinocchio 4.1.0: buildModelFromMJCF ignores the gravity of <option>; the model has 0 0 -9.81. It stores the damping and the
# friction loss of a joint in model.damping and model.friction, but aba does not use them. It stores the armature, and aba uses
# it. One would expect that aba uses all stored values, and that the reader reads gravity.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check pin==4.1.0
"$folder/environment/bin/python" - <<'PYTHON'
import tempfile
from pathlib import Path

import numpy as np
import pinocchio

MODEL = """<mujoco><option gravity="0 -5 0"/><worldbody><body name="b"><joint name="A" axis="0 0 1" armature="0.2" damping="0.5" frictionloss="1"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body></worldbody></mujoco>"""

with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "model.xml"
    file.write_text(MODEL)
    model = pinocchio.buildModelFromMJCF(str(file))
data, zero, rate = model.createData(), np.zeros(1), np.full(1, 2.0)
inertia = float(pinocchio.crba(model, data, zero)[0, 0])
acceleration = float(pinocchio.aba(model, data, zero, rate, zero)[0])
print(f"pinocchio {pinocchio.__version__}: gravity of the file 0 -5 0, of the model {model.gravity.linear}")
print(f"stored: damping {model.damping[0]}, friction {model.friction[0]}, armature {model.armature[0]}")
print(f"inertia of the joint {inertia:.3f} (with armature); acceleration at 2 rad/s {acceleration} rad/s2 (damping alone: -3.33)")
assert abs(model.gravity.linear - (0, 0, -9.81)).max() < 1e-12, "gravity is read now"
assert model.damping[0] == 0.5 and model.friction[0] == 1.0 and abs(inertia - 0.3) < 1e-12, "other values are stored"
assert acceleration == 0.0, "damping or friction acts now"
PYTHON
