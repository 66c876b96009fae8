#!/usr/bin/env bash
# A URDF file has two wheels, the second with <mimic joint="first" multiplier="2"/>. MuJoCo 4.0.1 reads it as an equality, and
# Drake 1.51.1 as a constraint. Pinocchio 4.1.0 couples the wheels only with `mimic=True`. PyBullet 3.2.7 never couples them.
# Neither prints a warning. One would expect that a reader of URDF couples the joints or refuses the tag.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check mujoco-core==4.0.1 pin==4.1.0 pybullet==3.2.7 drake==1.51.1
"$folder/environment/bin/python" - "$folder/wheels.urdf" <<'PYTHON' 2> /dev/null | tee "$folder/coupled"
import sys
from pathlib import Path

import mujoco
import pinocchio
import pybullet
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
JOINT = '<joint name="{0}" type="continuous"><parent link="base"/><child link="{0} wheel"/><axis xyz="0 0 1"/>{1}</joint>'
links = "".join(f'<link name="{name}">{INERTIAL}</link>' for name in ("first wheel", "second wheel"))
mimic = '<mimic joint="first" multiplier="2" offset="0"/>'
text = f'<robot name="wheels"><link name="base"/>{links}{JOINT.format("first", "")}{JOINT.format("second", mimic)}</robot>'

print("MuJoCo: equalities", mujoco.MjModel.from_xml_string(text).neq)
plant = MultibodyPlant(1e-3)
plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
Parser(plant).AddModelsFromString(text, "urdf")
plant.Finalize()
print("Drake: constraints", plant.num_constraints())
print("Pinocchio: freedoms", pinocchio.buildModelFromXML(text).nv, "and with mimic=True", pinocchio.buildModelFromXML(text, True).nv)
Path(sys.argv[1]).write_text(text)
pybullet.connect(pybullet.DIRECT)
body = pybullet.loadURDF(sys.argv[1], useFixedBase=True)
pybullet.setJointMotorControl2(body, 1, pybullet.VELOCITY_CONTROL, force=0)
pybullet.setJointMotorControl2(body, 0, pybullet.VELOCITY_CONTROL, targetVelocity=1, force=100)
for _ in range(240):
    pybullet.stepSimulation()
angles = [pybullet.getJointState(body, joint)[0] for joint in (0, 1)]
print("PyBullet: turned by", *(f"{angle:.2f}" for angle in angles))
PYTHON
grep -v "^b3\|^No inertial\|^pybullet" "$folder/coupled" | sed 's/^base//' | diff - <(cat <<'COUPLED'
MuJoCo: equalities 1
Drake: constraints 1
Pinocchio: freedoms 2 and with mimic=True 1
PyBullet: turned by 1.00 0.00
COUPLED
) || { echo "the behaviour has changed"; exit 1; }
