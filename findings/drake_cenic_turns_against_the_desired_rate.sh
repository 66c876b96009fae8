#!/usr/bin/env bash
# Drake 1.51.1 (and 1.58.0): an actuator with PdControllerGains turns its joint against the desired rate if CenicIntegrator
# integrates the plant. A discrete plant turns it with the desired rate, and CENIC itself follows a desired angle. One would
# expect the same sign in both.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check drake==1.51.1
"$folder/environment/bin/python" - <<'PYTHON'
from importlib.metadata import version

from pydrake.all import (
    AddMultibodyPlantSceneGraph,
    DiagramBuilder,
    MultibodyPlant,
    PdControllerGains,
    ResetIntegratorFromFlags,
    RevoluteJoint,
    Simulator,
    SpatialInertia,
    UnitInertia,
    default_model_instance,
)


def end(scheme, proportional, desired):
    """Angle [rad] and rate [rad/s] after a second, from rest, of a body on a driven hinge without gravity."""
    builder = DiagramBuilder()
    plant = MultibodyPlant(1e-3 if scheme == "discrete" else 0.0)
    plant.set_name("plant")
    AddMultibodyPlantSceneGraph(builder, plant)
    body = plant.AddRigidBody("body", SpatialInertia(1.0, [0.0, 0.0, 0.0], UnitInertia(0.5, 0.5, 0.5)))
    hinge = plant.AddJoint(RevoluteJoint("hinge", plant.world_frame(), body.body_frame(), [0.0, 0.0, 1.0]))
    plant.AddJointActuator("motor", hinge).set_controller_gains(PdControllerGains(p=proportional, d=50.0))
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram, diagram.CreateDefaultContext())
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    plant.get_desired_state_input_port(default_model_instance()).FixValue(context, desired)
    if scheme == "cenic":
        ResetIntegratorFromFlags(simulator, "cenic", 1e-3)
    simulator.Initialize()
    simulator.AdvanceTo(1.0)
    return hinge.get_angle(context), hinge.get_angular_rate(context)


print(f"drake {version('drake')}")
rates, angles = {}, {}
for scheme in ("discrete", "cenic"):
    rates[scheme] = end(scheme, 1e-6, [0.0, 2.0])[1]
    angles[scheme] = end(scheme, 1000.0, [0.5, 0.0])[0]
    print(f"{scheme}: desired rate 2, rate {rates[scheme]:.3f}; desired angle 0.5, angle {angles[scheme]:.3f}")
assert abs(rates["discrete"] - 2) < 0.01 and abs(rates["cenic"] + 2) < 0.01, "the behaviour has changed"
assert all(abs(angle - 0.5) < 0.01 for angle in angles.values()), "the behaviour has changed"
PYTHON
