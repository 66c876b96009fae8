// Physics engines of the browser behind one interface. One request a line on standard input, one answer a line on
// standard output, both JSON. engines/browser/engine.py writes the requests; numbers that are not finite become null.
import { createInterface } from "node:readline";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const [folder, name] = process.argv.slice(2), settings = JSON.parse(process.argv[4]);
const require = createRequire(pathToFileURL(`${folder}/`));
const TORQUE = 1e30; // of motors [N m]: above what a mechanism needs, below the largest number of single precision
const SPEED = 1e15; // Jolt's limit on speeds [m/s, rad/s], 500 and 47 as shipped: above those of a mechanism

const vector = ([x, y]) => ({ x, y });
const direction = (angle) => [Math.cos(angle), Math.sin(angle)];
const ends = (world, joint) => [joint.first, joint.second].map((index) => index < 0 ? world.ground : world.bodies[index]);

class Planck {
  static load() { return require("planck"); }

  constructor(planck, { bodies, joints, gravity }) {
    const { velocityIterations, positionIterations, ...limits } = settings;
    Object.assign(planck.Settings, limits); // of the module: all worlds of this process have the same settings
    this.iterations = [velocityIterations, positionIterations];
    this.world = new planck.World({ gravity: vector(gravity), allowSleep: false });
    this.ground = this.world.createBody();
    this.bodies = bodies.map(({ mass, inertia, pose, twist }) => {
      const body = this.world.createBody({
        type: "dynamic", position: vector(pose), angle: pose[2], linearVelocity: vector(twist), angularVelocity: twist[2],
      });
      body.setMassData({ mass, center: { x: 0, y: 0 }, I: inertia });
      return body;
    });
    const motor = ({ motor: speed }) => speed === null ? {} : { enableMotor: true, motorSpeed: speed, maxMotorTorque: TORQUE };
    const make = {
      Pin: (joint, pair) => new planck.RevoluteJoint({ ...pair, ...motor(joint) }),
      Weld: (joint, pair) => new planck.WeldJoint({ ...pair, referenceAngle: joint.angle }),
      Rod: (joint, pair) => new planck.DistanceJoint({ ...pair, length: joint.length }),
      Slot: (joint, pair) => {
        const line = { ...pair, localAxisA: vector(direction(joint.line)) };
        if (joint.angle !== null) return new planck.PrismaticJoint({ ...line, referenceAngle: joint.angle });
        return new planck.WheelJoint({ ...line, frequencyHz: 1e-9, dampingRatio: 0 }); // without a spring it gives NaN
      },
    };
    for (const joint of joints) {
      const [bodyA, bodyB] = ends(this, joint);
      const pair = { bodyA, bodyB, localAnchorA: vector(joint.points[0]), localAnchorB: vector(joint.points[1]) };
      this.world.createJoint(make[joint.kind](joint, pair));
    }
  }

  step(dt) { this.world.step(dt, ...this.iterations); }
  pose(body) { const { x, y } = body.getPosition(); return [x, y, body.getAngle()]; }
  twist(body) { const { x, y } = body.getLinearVelocity(); return [x, y, body.getAngularVelocity()]; }
  inertia(body) { return [body.getMass(), body.getInertia()]; }
}

class P2 {
  static load() {
    if (settings.double) globalThis.P2_ARRAY_TYPE = Float64Array; // as shipped vectors are in single precision
    return require("p2");
  }

  constructor(p2, { bodies, joints, gravity }) {
    this.world = new p2.World({ gravity });
    this.world.sleepMode = p2.World.NO_SLEEPING;
    const { stiffness, relaxation, double, ...solver } = settings;
    Object.assign(this.world.solver, solver);
    this.ground = new p2.Body();
    this.world.addBody(this.ground);
    this.bodies = bodies.map(({ mass, inertia, pose, twist }) => {
      const body = new p2.Body({
        mass, position: pose.slice(0, 2), angle: pose[2], velocity: twist.slice(0, 2), angularVelocity: twist[2],
        damping: 0, angularDamping: 0,
      });
      this.world.addBody(body);
      body.inertia = inertia; // p2 computes an inertia from shapes, and there are none
      body.invInertia = 1 / inertia;
      body.updateSolveMassProperties();
      return body;
    });
    const make = {
      Pin: (joint, a, b) => {
        const pin = new p2.RevoluteConstraint(a, b, { localPivotA: joint.points[0], localPivotB: joint.points[1] });
        if (joint.motor !== null) {
          pin.enableMotor();
          pin.setMotorSpeed(-joint.motor); // p2's speed is that of the first body against the second
        }
        return pin;
      },
      // The offset of the second body's origin in the first body's frame is that of the start.
      Weld: (joint, a, b) => new p2.LockConstraint(a, b),
      Rod: (joint, a, b) => new p2.DistanceConstraint(a, b,
        { localAnchorA: joint.points[0], localAnchorB: joint.points[1], distance: joint.length }),
      Slot: (joint, a, b) => {
        const slot = new p2.PrismaticConstraint(a, b, {
          localAnchorA: joint.points[0], localAnchorB: joint.points[1], localAxisA: direction(joint.line),
          disableRotationalLock: joint.angle === null,
        });
        if (joint.angle !== null) slot.equations[1].angle = joint.angle;
        return slot;
      },
    };
    for (const joint of joints) this.world.addConstraint(make[joint.kind](joint, ...ends(this, joint)));
    this.world.setGlobalStiffness(stiffness);
    this.world.setGlobalRelaxation(relaxation);
  }

  step(dt) { this.world.step(dt); }
  pose(body) { return [body.position[0], body.position[1], body.angle]; }
  twist(body) { return [body.velocity[0], body.velocity[1], body.angularVelocity]; }
  inertia(body) { return [body.mass, body.inertia]; }
}

class Rapier {
  static async load() {
    const rapier = require("@dimforge/rapier2d-compat");
    await rapier.init();
    return rapier;
  }

  constructor(rapier, { bodies, joints, gravity, dt }) {
    this.world = new rapier.World(vector(gravity));
    const { motor, ...parameters } = settings;
    Object.assign(this.world.integrationParameters, parameters);
    this.world.timestep = dt;
    this.ground = this.world.createRigidBody(rapier.RigidBodyDesc.fixed());
    this.bodies = bodies.map(({ mass, inertia, pose, twist }) => this.world.createRigidBody(
      rapier.RigidBodyDesc.dynamic().setTranslation(pose[0], pose[1]).setRotation(pose[2])
        .setLinvel(twist[0], twist[1]).setAngvel(twist[2]).setCanSleep(false)
        .setAdditionalMassProperties(mass, { x: 0, y: 0 }, inertia)));
    const make = {
      Pin: (points) => rapier.JointData.revolute(...points),
      Weld: ([first, second], joint) => rapier.JointData.fixed(first, joint.angle, second, 0),
      Slot: ([first, second], joint) => rapier.JointData.prismatic(first, second, vector(direction(joint.line))),
    };
    for (const joint of joints) {
      const data = make[joint.kind](joint.points.map(vector), joint);
      const made = this.world.createImpulseJoint(data, ...ends(this, joint), true);
      if (joint.motor !== null) {
        made.configureMotorModel(rapier.MotorModel.AccelerationBased);
        made.configureMotorVelocity(joint.motor, motor);
      }
    }
  }

  step() { this.world.step(); }
  pose(body) { const { x, y } = body.translation(); return [x, y, body.rotation()]; }
  twist(body) { const { x, y } = body.linvel(); return [x, y, body.angvel()]; }
  inertia(body) {
    body.recomputeMassPropertiesFromColliders(); // else zero before the first step
    return [body.mass(), body.principalInertia()];
  }
}

class Jolt {
  static async load() { return (await import(pathToFileURL(require.resolve("jolt-physics/wasm-compat")))).default(); }

  constructor(jolt, { bodies, joints, gravity }) {
    this.jolt = jolt;
    const start = new jolt.JoltSettings();
    const filter = new jolt.ObjectLayerPairFilterTable(1); // one layer, which collides with nothing
    const broad = new jolt.BroadPhaseLayerInterfaceTable(1, 1);
    broad.MapObjectToBroadPhaseLayer(0, new jolt.BroadPhaseLayer(0));
    start.mObjectLayerPairFilter = filter;
    start.mBroadPhaseLayerInterface = broad;
    start.mObjectVsBroadPhaseLayerFilter = new jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 1, filter, 1);
    this.interface = new jolt.JoltInterface(start);
    this.system = this.interface.GetPhysicsSystem();
    this.system.SetGravity(this.vector(gravity));
    const physics = this.system.GetPhysicsSettings();
    Object.assign(physics, settings);
    this.system.SetPhysicsSettings(physics);
    const shape = new jolt.SphereShape(0.01, null), here = this.system.GetBodyInterface();
    const at = (kind, { pose = [0, 0, 0] }) => new jolt.BodyCreationSettings(shape, this.point(pose),
      new jolt.Quat(0, 0, Math.sin(pose[2] / 2), Math.cos(pose[2] / 2)), kind, 0);
    const add = (creation) => {
      const body = here.CreateBody(creation);
      here.AddBody(body.GetID(), jolt.EActivation_Activate);
      return body;
    };
    this.ground = add(at(jolt.EMotionType_Static, {}));
    this.bodies = bodies.map((body) => {
      const creation = at(jolt.EMotionType_Dynamic, body), { mass, inertia, twist } = body;
      creation.mAllowedDOFs = jolt.EAllowedDOFs_Plane2D;
      creation.mAllowSleeping = false;
      creation.mLinearDamping = creation.mAngularDamping = 0;
      creation.mMaxLinearVelocity = creation.mMaxAngularVelocity = SPEED;
      creation.mLinearVelocity = this.vector(twist);
      creation.mAngularVelocity = new jolt.Vec3(0, 0, twist[2]);
      creation.mOverrideMassProperties = jolt.EOverrideMassProperties_MassAndInertiaProvided;
      creation.mMassPropertiesOverride.mMass = mass;
      creation.mMassPropertiesOverride.mInertia = jolt.Mat44.prototype.sScale(inertia);
      return add(creation);
    });
    const fixed = (joint, Settings) => {
      const made = new Settings();
      made.mSpace = jolt.EConstraintSpace_LocalToBodyCOM;
      made.mPoint1 = this.point(joint.points[0]);
      made.mPoint2 = this.point(joint.points[1]);
      return made;
    };
    const axes = (made, angle) => { // the first body's axes, at this angle in the second body's frame
      made.mAxisX1 = new jolt.Vec3(1, 0, 0);
      made.mAxisY1 = new jolt.Vec3(0, 1, 0);
      made.mAxisX2 = this.vector(direction(-angle));
      made.mAxisY2 = this.vector(direction(Math.PI / 2 - angle));
      return made;
    };
    const make = {
      Pin: (joint) => {
        const made = fixed(joint, jolt.HingeConstraintSettings);
        made.mHingeAxis1 = made.mHingeAxis2 = new jolt.Vec3(0, 0, 1);
        made.mNormalAxis1 = made.mNormalAxis2 = new jolt.Vec3(1, 0, 0);
        return made;
      },
      Weld: (joint) => axes(fixed(joint, jolt.FixedConstraintSettings), joint.angle),
      Rod: (joint) => {
        const made = fixed(joint, jolt.DistanceConstraintSettings);
        made.mMinDistance = made.mMaxDistance = joint.length;
        return made;
      },
      Slot: (joint) => {
        const made = fixed(joint, jolt.SliderConstraintSettings), angle = joint.line - joint.angle;
        made.mSliderAxis1 = this.vector(direction(joint.line));
        made.mSliderAxis2 = this.vector(direction(angle));
        made.mNormalAxis1 = made.mNormalAxis2 = new jolt.Vec3(0, 0, 1);
        return made;
      },
    };
    for (const joint of joints) {
      const made = make[joint.kind](joint).Create(...ends(this, joint));
      this.system.AddConstraint(made);
      if (joint.motor !== null) {
        const hinge = jolt.castObject(made, jolt.HingeConstraint);
        hinge.SetMotorState(jolt.EMotorState_Velocity);
        hinge.SetTargetAngularVelocity(joint.motor);
      }
    }
  }

  vector([x, y]) { return new this.jolt.Vec3(x, y, 0); }
  point([x, y]) { return new this.jolt.RVec3(x, y, 0); }
  step(dt) { this.interface.Step(dt, 1); }
  pose(body) {
    const at = body.GetCenterOfMassPosition(), turn = body.GetRotation();
    return [at.GetX(), at.GetY(), 2 * Math.atan2(turn.GetZ(), turn.GetW())];
  }
  twist(body) {
    const speed = body.GetLinearVelocity();
    return [speed.GetX(), speed.GetY(), body.GetAngularVelocity().GetZ()];
  }
  inertia(body) {
    const motion = body.GetMotionProperties();
    return [1 / motion.GetInverseMass(), 1 / motion.GetInverseInertiaDiagonal().GetZ()];
  }
  close() { this.jolt.destroy(this.interface); }
}

// Samples of trial runs of WARM_STEPS steps: after them Node has compiled the code, and a step costs the same from then on.
const WARM_RUNS = [1000, 10, 1000], WARM_STEPS = 3000;
const ENGINES = { planck: Planck, p2: P2, rapier: Rapier, jolt: Jolt };
const World = ENGINES[name], worlds = new Map(), warm = new Set();

// The states at the samples, the twists one step before each sample, and the CPU time [s] of stepping and recording.
function run(world, dt, samples, every) {
  const { bodies } = world, poses = [], twists = [], before = [];
  const record = () => {
    poses.push(bodies.map((body) => world.pose(body)));
    twists.push(bodies.map((body) => world.twist(body)));
  };
  record();
  const begin = process.cpuUsage();
  for (let sample = 0; sample < samples; sample++) {
    for (let step = 1; step < every; step++) world.step(dt);
    before.push(bodies.map((body) => world.twist(body)));
    world.step(dt);
    record();
  }
  const { user, system } = process.cpuUsage(begin);
  return { poses, twists, before, seconds: (user + system) / 1e6 };
}

function warmUp(engine, mechanism) {
  const kinds = mechanism.joints.map((joint) => joint.kind).sort().join();
  if (warm.has(kinds)) return;
  for (const samples of WARM_RUNS) {
    const trial = new World(engine, mechanism);
    try {
      run(trial, mechanism.dt, samples, WARM_STEPS / samples);
    } finally {
      trial.close?.();
    }
  }
  warm.add(kinds);
}

const handle = {
  build({ id, ...mechanism }, engine) {
    const world = new World(engine, mechanism);
    worlds.set(id, [world, mechanism]);
    return { inertias: world.bodies.map((body) => world.inertia(body)) };
  },
  run({ id, samples, every }, engine) {
    const [world, mechanism] = worlds.get(id);
    warmUp(engine, mechanism);
    return run(world, mechanism.dt, samples, every);
  },
};

function drop(id) {
  worlds.get(id)?.[0].close?.();
  worlds.delete(id);
}

const engine = await World.load();
for await (const line of createInterface({ input: process.stdin })) {
  const { operation, unused, ...request } = JSON.parse(line);
  unused.forEach(drop);
  let answer;
  try {
    answer = handle[operation](request, engine);
  } catch (error) {
    answer = { error: String(error?.message ?? error) };
  }
  process.stdout.write(`${JSON.stringify(answer)}\n`);
}
