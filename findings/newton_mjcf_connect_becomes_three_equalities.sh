#!/usr/bin/env bash
# Newton 1.8.0 (mujoco 3.17.0, mujoco-warp 3.17.0): add_mjcf reads a four-bar with one `connect`, and SolverMuJoCo builds a model
# with three equalities. Two of them are inactive welds. The gravity and the time step of <option> are ignored.
# SolverFeatherstone steps the same model with an open loop, without an error or a warning; the gap is 0.99 m after a second.
# One would expect one equality, the file's gravity, and an error by a solver that can't enforce the joint.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check newton==1.8.0 warp-lang==1.19.0 mujoco==3.17.0 mujoco-warp==3.17.0
"$folder/environment/bin/python" - <<'PYTHON' | tee "$folder/output"
import math
import warnings

import warp

warp.config.quiet = True
import newton

LENGTHS = {"crank": 0.3, "coupler": math.hypot(0.8, 0.3), "rocker": math.hypot(0.1, 0.6)}
ANGLES = {"crank": math.pi / 2, "coupler": math.atan2(0.3, 0.8) - math.pi / 2, "rocker": math.atan2(0.6, 0.1)}


def bar(name, place, inner=""):
    length, moment = LENGTHS[name], LENGTHS[name] ** 3 / 12
    return (
        f'<body name="{name}" pos="{place} 0 0" axisangle="0 0 1 {ANGLES[name]!r}"><joint name="{name}" axis="0 0 1"/>'
        f'<inertial pos="{length / 2!r} 0 0" mass="{length!r}" diaginertia="{moment!r} {moment!r} {moment!r}"/>'
        f'<site name="end of {name}" pos="{length!r} 0 0"/>{inner}</body>'
    )


text = (
    '<mujoco><compiler angle="radian"/><option timestep="0.001" gravity="0 -9.81 0"/><worldbody>'
    f'{bar("crank", 0, bar("coupler", 0.3))}{bar("rocker", 0.7)}</worldbody>'
    '<equality><connect site1="end of coupler" site2="end of rocker"/></equality></mujoco>'
)
builder = newton.ModelBuilder()
newton.solvers.SolverMuJoCo.register_custom_attributes(builder)
builder.add_mjcf(text)
model = builder.finalize(device="cpu")
built = newton.solvers.SolverMuJoCo(model, use_mujoco_cpu=True).mj_model
print("equalities", built.neq, "of which active", int(built.eq_active0.sum()))
print("gravity", *(f"{component:.2f}" for component in abs(built.opt.gravity)), "time step", built.opt.timestep)

model.set_gravity((0.0, -9.81, 0.0))
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    solver = newton.solvers.SolverFeatherstone(model)
    now, after, control = model.state(), model.state(), model.control()
    newton.eval_fk(model, model.joint_q, model.joint_qd, now)
    for _ in range(1000):
        now.clear_forces()
        solver.step(now, after, control, None, 1e-3)
        now, after = after, now
ends = []
for name in ("coupler", "rocker"):
    (number,) = [number for number, label in enumerate(model.body_label) if label.endswith(name)]
    x, y, _, _, _, sine, cosine = now.body_q.numpy()[number]
    angle = 2 * math.atan2(sine, cosine)
    ends.append((x + LENGTHS[name] * math.cos(angle), y + LENGTHS[name] * math.sin(angle)))
print(f"Featherstone: warnings {len(caught)}, the loop's gap {math.dist(*ends):.2f} m")
PYTHON
grep "^equalities\|^gravity\|^Featherstone" "$folder/output" | diff - <(cat <<'OUTPUT'
equalities 3 of which active 1
gravity 0.00 0.00 9.81 time step 0.002
Featherstone: warnings 0, the loop's gap 0.99 m
OUTPUT
) || { echo "the behaviour has changed"; exit 1; }
