#!/usr/bin/env bash
# planck 1.5.0: the documentation of WheelJoint calls frequencyHz 0 "no suspension", but the body's pose is NaN in the second step.
# With frequencyHz 1e-9 the body slides on the line, as expected. One would expect a joint without a spring, as in Box2D, of which
# planck is a translation.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
npm install --silent --no-audit --no-fund planck@1.5.0
cat > slide.cjs <<'JAVASCRIPT'
const planck = require("planck");

for (const frequencyHz of [0, 1e-9]) {
  const world = new planck.World({ gravity: { x: 1, y: -10 } }), ground = world.createBody();
  const block = world.createBody({ type: "dynamic" });
  block.setMassData({ mass: 1, center: { x: 0, y: 0 }, I: 1 });
  const zero = { x: 0, y: 0 };
  world.createJoint(new planck.WheelJoint({
    frequencyHz, dampingRatio: 0, bodyA: ground, bodyB: block, localAnchorA: zero, localAnchorB: zero, localAxisA: { x: 1, y: 0 },
  }));
  for (let i = 0; i < 60; i++) world.step(1 / 60);
  console.log(frequencyHz, block.getPosition().x.toFixed(3));
}
JAVASCRIPT
node slide.cjs | tee positions
diff positions - <<'POSITIONS' || { echo "the behaviour has changed"; exit 1; }
0 NaN
1e-9 0.508
POSITIONS
