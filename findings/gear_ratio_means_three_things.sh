#!/usr/bin/env bash
# pymunk 7.3.1, planck 1.5.0, p2 0.7.1: a gear joint with ratio 2 connects wheel a, which is driven, to wheel b. The rate of wheel
# b is +1/2 of the rate of wheel a in pymunk, -1/2 in planck, and +2 in p2. A motor with speed 1 between the ground and wheel a
# turns the wheel by +1 rad/s in planck, and by -1 rad/s in p2 and pymunk. One would expect the same meaning of a gear ratio, at
# least up to its sign.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check pymunk==7.3.1
"$folder/environment/bin/python" - <<'PYTHON' | tee "$folder/rates"
import pymunk

space = pymunk.Space()
wheels = [pymunk.Body(1, 1) for _ in range(2)]
for wheel in wheels:
    space.add(wheel, pymunk.PivotJoint(space.static_body, wheel, (0, 0), (0, 0)))
space.add(pymunk.SimpleMotor(space.static_body, wheels[0], rate=1), pymunk.GearJoint(*wheels, phase=0, ratio=2))
for _ in range(600):
    space.step(1 / 60)
print("pymunk", *(f"{wheel.angular_velocity:.3f}" for wheel in wheels))
PYTHON
cd "$folder"
npm install --silent --no-audit --no-fund planck@1.5.0 p2@0.7.1
node - <<'JAVASCRIPT' | tee -a "$folder/rates"
const planck = require("planck"), p2 = require("p2");

{
  const world = planck.World({ gravity: { x: 0, y: 0 } }), ground = world.createBody();
  const wheels = [0, 1].map(() => {
    const wheel = world.createBody({ type: "dynamic" });
    wheel.createFixture({ shape: planck.Box(0.5, 0.5), density: 1, filterMaskBits: 0 });
    return wheel;
  });
  const settings = [{ enableMotor: true, motorSpeed: 1, maxMotorTorque: 1000 }, {}];
  const pins = wheels.map((wheel, i) => world.createJoint(planck.RevoluteJoint(settings[i], ground, wheel, planck.Vec2(0, 0))));
  world.createJoint(planck.GearJoint({}, wheels[0], wheels[1], pins[0], pins[1], 2));
  for (let i = 0; i < 600; i++) world.step(1 / 60);
  console.log("planck", ...wheels.map((wheel) => wheel.getAngularVelocity().toFixed(3)));
}
{
  const world = new p2.World({ gravity: [0, 0] }), ground = new p2.Body({ mass: 0 });
  world.applyDamping = false;
  world.addBody(ground);
  const wheels = [0, 1].map(() => {
    const wheel = new p2.Body({ mass: 1 });
    wheel.addShape(new p2.Box({ width: 1, height: 1, collisionGroup: 0 }));
    world.addBody(wheel);
    return wheel;
  });
  const pins = wheels.map((wheel) => new p2.RevoluteConstraint(ground, wheel, { worldPivot: [0, 0] }));
  pins[0].enableMotor();
  pins[0].setMotorSpeed(1);
  for (const constraint of [...pins, new p2.GearConstraint(wheels[0], wheels[1], { ratio: 2 })]) world.addConstraint(constraint);
  for (let i = 0; i < 600; i++) world.step(1 / 60);
  console.log("p2", ...wheels.map((wheel) => wheel.angularVelocity.toFixed(3)));
}
JAVASCRIPT
diff "$folder/rates" - <<'RATES' || { echo "the behaviour has changed"; exit 1; }
pymunk -1.000 -0.500
planck 1.000 -0.500
p2 -1.000 -2.000
RATES
