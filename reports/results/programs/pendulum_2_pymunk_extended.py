"""Pendulum 2 in pymunk by the method *extended*."""

import numpy as np
import pymunk

duration = 2.0  # s
steps = 600
dt = duration / steps  # s

# Mass [kg], moment of inertia [kg m^2], centre of mass [m], angle [rad], velocity [m/s], rate [rad/s].
BODIES = {
    "link 1": (1, 0.0833333333333, (0.5, 0), 0, (0, 0), 0),
    "link 2": (1, 0.0833333333333, (1.5, 0), 0, (0, 0), 0),
}
# Points [m] that coincide, relative to the centres of mass of their bodies; None is the ground.
PINS = [
    (None, (0, 0), "link 1", (-0.5, 0)),
    ("link 1", (0.5, 0), "link 2", (-0.5, 0)),
]


def run(dt):
    """Return the position [m] and angle [rad] of the link 2 after `duration` with the step dt."""
    space = pymunk.Space()
    space.gravity = (0, -9.81)
    space.iterations = 5
    bodies = {None: space.static_body}
    for name, (mass, moment, place, angle, velocity, rate) in BODIES.items():
        body = bodies[name] = pymunk.Body(mass, moment)
        body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, rate
        space.add(body)
    joints = [pymunk.PivotJoint(bodies[a], bodies[b], one, other) for a, one, b, other in PINS]
    for joint in joints:
        joint.error_bias = 0  # each step closes the whole gap
        space.add(joint)
    # Apply forces for half a step without moving bodies: velocities are then half a step ahead of positions.
    for name in BODIES:
        bodies[name].position_func = lambda body, dt: None
    space.step(dt / 2)
    for name in BODIES:
        bodies[name].position_func = pymunk.Body.update_position
    for _ in range(round(duration / dt)):
        space.step(dt)
    body = bodies["link 2"]
    return body.position.x, body.position.y, body.angle


# The error is a series in dt^2, dt^3, dt^4, dt^5, so five runs remove these four terms.
LEVELS = (2, 3, 4, 6, 8)
powers = [[(2 / level) ** power for level in LEVELS] for power in (0, 2, 3, 4, 5)]
weights = np.linalg.solve(powers, [1, 0, 0, 0, 0])
end = weights @ [run(dt / level) for level in LEVELS]
print("link 2: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: link 2: x = 0.1154304525 m, y = -1.4556620515 m, angle = -1.1634342519 rad
