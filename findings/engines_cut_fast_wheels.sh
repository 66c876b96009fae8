#!/usr/bin/env bash
# A free wheel at 100 rad/s after one step of 1/60 s: Rapier 0.21.0 and Jolt (jolt-physics 1.1.0) have reduced the rate to 47.12
# rad/s, and planck 1.5.0 to 94.25 rad/s. The rate in p2 0.7.1 and pymunk 7.3.1 is unchanged. No engine prints a warning. Rapier
# limits a step to an eighth of a turn, and planck to a quarter. Jolt's limit is a property of the body and does not depend on the
# step. One would expect a constant rate, or limits above 1000 rpm.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv environment
environment/bin/python -m pip install --quiet --disable-pip-version-check pymunk==7.3.1
npm install --silent --no-audit --no-fund planck@1.5.0 p2@0.7.1 @dimforge/rapier2d-compat@0.21.0 jolt-physics@1.1.0
environment/bin/python - <<'PYTHON' | tee rates
import pymunk

for step in (1 / 60, 1 / 240):
    space, wheel = pymunk.Space(), pymunk.Body(1, 1)
    wheel.angular_velocity = 100
    space.add(wheel)
    space.step(step)
    print(f"pymunk 1/{1 / step:.0f} {wheel.angular_velocity:.2f}")
PYTHON
cat > wheels.mjs <<'JAVASCRIPT'
import Jolt from "jolt-physics/wasm-compat";
import p2 from "p2";
import planck from "planck";
import rapier from "@dimforge/rapier2d-compat";

await rapier.init();
const jolt = await Jolt(), zero = { x: 0, y: 0 };
const engines = {
  rapier(step) {
    const world = new rapier.World(zero);
    world.timestep = step;
    const wheel = world.createRigidBody(rapier.RigidBodyDesc.dynamic().setAngvel(100).setAdditionalMassProperties(1, zero, 1));
    world.step();
    return wheel.angvel();
  },
  jolt(step) {
    const settings = new jolt.JoltSettings(), pairs = new jolt.ObjectLayerPairFilterTable(1);
    const layers = new jolt.BroadPhaseLayerInterfaceTable(1, 1);
    layers.MapObjectToBroadPhaseLayer(0, new jolt.BroadPhaseLayer(0));
    settings.mObjectLayerPairFilter = pairs;
    settings.mBroadPhaseLayerInterface = layers;
    settings.mObjectVsBroadPhaseLayerFilter = new jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, pairs, 1);
    const world = new jolt.JoltInterface(settings), bodies = world.GetPhysicsSystem().GetBodyInterface();
    const creation = new jolt.BodyCreationSettings(
      new jolt.SphereShape(0.5, null), new jolt.RVec3(0, 0, 0), new jolt.Quat(0, 0, 0, 1), jolt.EMotionType_Dynamic, 0);
    creation.mAngularVelocity = new jolt.Vec3(0, 0, 100);
    creation.mAngularDamping = 0;
    const wheel = bodies.CreateBody(creation);
    bodies.AddBody(wheel.GetID(), jolt.EActivation_Activate);
    world.Step(step, 1);
    return wheel.GetAngularVelocity().GetZ();
  },
  planck(step) {
    const world = new planck.World({ gravity: zero }), wheel = world.createBody({ type: "dynamic", angularVelocity: 100 });
    wheel.setMassData({ mass: 1, center: zero, I: 1 });
    world.step(step);
    return wheel.getAngularVelocity();
  },
  p2(step) {
    const world = new p2.World({ gravity: [0, 0] }), wheel = new p2.Body({ mass: 1, angularVelocity: 100, angularDamping: 0 });
    world.addBody(wheel);
    world.step(step);
    return wheel.angularVelocity;
  },
};
for (const [name, rate] of Object.entries(engines))
  for (const steps of [60, 240]) console.log(name, `1/${steps}`, rate(1 / steps).toFixed(2));
JAVASCRIPT
node wheels.mjs | tee -a rates
diff rates - <<'RATES' || { echo "the behaviour has changed"; exit 1; }
pymunk 1/60 100.00
pymunk 1/240 100.00
rapier 1/60 47.12
rapier 1/240 100.00
jolt 1/60 47.12
jolt 1/240 47.12
planck 1/60 94.25
planck 1/240 100.00
p2 1/60 100.00
p2 1/240 100.00
RATES
