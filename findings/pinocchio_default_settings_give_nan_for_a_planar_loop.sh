#!/usr/bin/env bash
# Pinocchio 4.1.0: constraintDynamics returns NaN for all accelerations of a planar four-bar whose loop is a CONTACT_3D, without an
# error. The row normal to the plane is zero, and the default regularisation mu of ProximalSettings is 0. With mu = 1e-10 and three
# iterations the accelerations have an error below 1e-8. More iterations with mu = 0 have no effect. One would expect an error,
# or the solution of least norm, since the rows are consistent.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check pin==4.1.0
"$folder/environment/bin/python" - <<'PYTHON' | tee "$folder/accelerations"
import math

import numpy as np
import pinocchio as pin

AB, BC, DC = 0.3, math.hypot(0.8, 0.3), math.hypot(0.1, 0.6)


def at(x, angle=0.0):
    return pin.SE3(pin.utils.rotate("z", angle), np.array([x, 0.0, 0.0]))


def add(parent, place, length, name):
    joint = model.addJoint(parent, pin.JointModelRZ(), place, name)
    inertia = pin.Inertia(length, np.array([length / 2, 0.0, 0.0]), np.eye(3) * length**3 / 12)
    model.appendBodyToJoint(joint, inertia, pin.SE3.Identity())
    return joint


model = pin.Model()
crank = add(0, at(0.0, math.pi / 2), AB, "A")
coupler = add(crank, at(AB, math.atan2(0.3, 0.8) - math.pi / 2), BC, "B")
rocker = add(0, at(0.7, math.atan2(0.6, 0.1)), DC, "D")
model.gravity.linear = np.array([0.0, -9.81, 0.0])
loop = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, coupler, at(BC), rocker, at(DC), pin.ReferenceFrame.LOCAL)
for label, settings in (
    ("as shipped", pin.ProximalSettings()),
    ("mu 0, 20 iterations", pin.ProximalSettings(1e-12, 0.0, 20)),
    ("mu 1e-10, 20 iterations", pin.ProximalSettings(1e-12, 1e-10, 20)),
):
    data, loops, results = model.createData(), pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    loops.append(loop)
    results.append(loop.createData())
    pin.initConstraintDynamics(model, data, loops, results)
    zero = np.zeros(3)
    found = pin.constraintDynamics(model, data, zero, zero, zero, loops, results, settings)
    print(label, *(f"{value:.4f}" for value in found))
PYTHON
diff "$folder/accelerations" - <<'ACCELERATIONS' || { echo "the behaviour has changed"; exit 1; }
as shipped nan nan nan
mu 0, 20 iterations nan nan nan
mu 1e-10, 20 iterations -3.3776 3.1524 -1.8014
ACCELERATIONS
