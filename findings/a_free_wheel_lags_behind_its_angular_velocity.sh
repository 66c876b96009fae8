#!/usr/bin/env bash
# Rapier 0.21.0 and Box2D 3.1.1 (pyb2d3 0.11.1): a free wheel at 40 rad/s turns by 39.64 rad in a second, while its angular
# velocity remains 40 rad/s. Both engines add a multiple of the normal to the rotation (c, s) and normalise the sum. This turns the
# wheel by atan(w h) in each step instead of w h. One would expect 40 rad, as in planck 1.5.0 and p2 0.7.1.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv environment
environment/bin/python -m pip install --quiet --disable-pip-version-check pyb2d3==0.11.1
npm install --silent --no-audit --no-fund planck@1.5.0 p2@0.7.1 @dimforge/rapier2d-compat@0.21.0
environment/bin/python - <<'PYTHON' | tee turned
import math

import pyb2d3

world, upright, masses = pyb2d3.World(gravity=(0, 0)), pyb2d3.Rot(), pyb2d3.MassData()
upright.c, upright.s = 1, 0
wheel = world.create_dynamic_body(position=(0, 0), rotation=upright, angular_velocity=40, enable_sleep=False)
masses.mass, masses.center, masses.rotational_inertia = 1, (0, 0), 1
wheel.mass_data = masses
turned = last = 0
for _ in range(60):
    world.step(1 / 60, 4)
    angle = math.atan2(wheel.rotation.s, wheel.rotation.c)
    turned, last = turned + (angle - last) % (2 * math.pi), angle
print(f"box2d {wheel.angular_velocity:.2f} {turned:.2f}")
PYTHON
cat > wheels.cjs <<'JAVASCRIPT'
const planck = require("planck"), p2 = require("p2"), rapier = require("@dimforge/rapier2d-compat");

const report = (name, rate, turned) => console.log(name, rate.toFixed(2), turned.toFixed(2));
rapier.init().then(() => {
  {
    const world = new rapier.World({ x: 0, y: 0 }), turn = 2 * Math.PI;
    const wheel = world.createRigidBody(rapier.RigidBodyDesc.dynamic().setAngvel(40).setAdditionalMassProperties(1, { x: 0, y: 0 }, 1));
    let turned = 0, last = 0;
    for (let i = 0; i < 60; i++) {
      world.step(); // 1/60 s as shipped
      const angle = wheel.rotation();
      turned += (((angle - last) % turn) + turn) % turn;
      last = angle;
    }
    report("rapier", wheel.angvel(), turned);
  }
  {
    const world = new planck.World({ gravity: { x: 0, y: 0 } });
    const wheel = world.createBody({ type: "dynamic", angularVelocity: 40 });
    wheel.setMassData({ mass: 1, center: { x: 0, y: 0 }, I: 1 });
    for (let i = 0; i < 60; i++) world.step(1 / 60);
    report("planck", wheel.getAngularVelocity(), wheel.getAngle());
  }
  {
    const world = new p2.World({ gravity: [0, 0] }), wheel = new p2.Body({ mass: 1, angularVelocity: 40, angularDamping: 0 });
    world.addBody(wheel);
    for (let i = 0; i < 60; i++) world.step(1 / 60);
    report("p2", wheel.angularVelocity, wheel.angle);
  }
});
JAVASCRIPT
node wheels.cjs | tee -a turned
diff turned - <<'TURNED' || { echo "the behaviour has changed"; exit 1; }
box2d 40.00 39.64
rapier 40.00 39.64
planck 40.00 40.00
p2 40.00 40.00
TURNED
