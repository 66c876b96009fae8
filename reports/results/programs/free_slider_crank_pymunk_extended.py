"""Free slider crank in pymunk by the method *extended*."""

import numpy as np
import pymunk

duration = 2.0  # s
steps = 600  # 600: below 1e-6; 2000: below 1e-9
dt = duration / steps  # s

# Mass [kg], moment of inertia [kg m^2], centre of mass [m], angle [rad], velocity [m/s], rate [rad/s].
BODIES = {
    "crank": (0.3, 0.00225, (0.131637384284, 0.0719138307906), 0.5, (-0.719138307906, 1.31637384284), 10),
    "rod": (
        1,
        0.0833333333333,
        (0.758076143809, 0.0719138307906),
        -0.144328214646,
        (-1.62959679099, 1.31637384284),
        -2.66040861789,
    ),
    "slider": (0.5, float("inf"), (1.25287751905, 0), 0, (-1.82091696617, 0), 0),
}
# Points [m] that coincide, relative to the centres of mass of their bodies; None is the ground.
PINS = [
    (None, (0, 0), "crank", (-0.15, 0)),
    ("crank", (0.15, 0), "rod", (-0.5, 0)),
    ("rod", (0.5, 0), "slider", (0, 0)),
]


def run(dt):
    """Return the position [m] and angle [rad] of the rod after `duration` with the step dt."""
    space = pymunk.Space()
    space.gravity = (0, -9.81)
    space.iterations = 200  # the first impulses start from zero, so they need many iterations
    bodies = {None: space.static_body}
    for name, (mass, moment, place, angle, velocity, rate) in BODIES.items():
        body = bodies[name] = pymunk.Body(mass, moment)
        body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, rate
        space.add(body)
    joints = [pymunk.PivotJoint(bodies[a], bodies[b], one, other) for a, one, b, other in PINS]
    # A GrooveJoint is exact here, because its anchor is a centre of mass. It has two ends, so it is long.
    joints.append(pymunk.GrooveJoint(space.static_body, bodies["slider"], (-1000, 0), (1000, 0), (0, 0)))
    for joint in joints:
        joint.error_bias = 0  # each step closes the whole gap
        space.add(joint)
    # Apply forces for half a step without moving bodies: velocities are then half a step ahead of positions.
    for name in BODIES:
        bodies[name].position_func = lambda body, dt: None
    space.step(dt / 2)
    for name in BODIES:
        bodies[name].position_func = pymunk.Body.update_position
    for step in range(round(duration / dt)):
        space.iterations = 200 if step < 4 else 8
        space.step(dt)
    body = bodies["rod"]
    return body.position.x, body.position.y, body.angle


# The error is a series in dt^2, dt^3, dt^4, dt^5, so five runs remove these four terms.
LEVELS = (2, 3, 4, 6, 8)
powers = [[(2 / level) ** power for level in LEVELS] for power in (0, 2, 3, 4, 5)]
weights = np.linalg.solve(powers, [1, 0, 0, 0, 0])
end = weights @ [run(dt / level) for level in LEVELS]
print("rod: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: rod: x = 0.5738685427 m, y = 0.1423535788 m, angle = -0.2887009293 rad
