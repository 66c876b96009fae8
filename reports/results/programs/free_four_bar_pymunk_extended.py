"""Free four bar in pymunk by the method *extended*."""

import numpy as np
import pymunk

duration = 1.0  # s
steps = 300
dt = duration / steps  # s

# Mass [kg], moment of inertia [kg m^2], centre of mass [m], angle [rad], velocity [m/s], rate [rad/s].
BODIES = {
    "crank": (0.4, 0.00533333333333, (0, 0.2), 1.57079632679, (0, 0), 0),
    "coupler": (0.565685424949, 0.0150849446653, (0.2, 0.6), 0.785398163397, (0, 0), 0),
    "rocker": (1.1313708499, 0.120679557323, (0.8, 0.4), 2.35619449019, (0, 0), 0),
}
# Points [m] that coincide, relative to the centres of mass of their bodies; None is the ground.
PINS = [
    (None, (0, 0), "crank", (-0.2, 0)),
    ("crank", (0.2, 0), "coupler", (-0.282842712475, 0)),
    ("coupler", (0.282842712475, 0), "rocker", (0.565685424949, 0)),
    (None, (1.2, 0), "rocker", (-0.565685424949, 0)),
]


def run(dt):
    """Return the position [m] and angle [rad] of the rocker after `duration` with the step dt."""
    space = pymunk.Space()
    space.gravity = (0, -9.81)
    space.iterations = 192  # the first impulses start from zero, so they need many iterations
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
    for step in range(round(duration / dt)):
        space.iterations = 192 if step < 4 else 8
        space.step(dt)
    body = bodies["rocker"]
    return body.position.x, body.position.y, body.angle


# The error is a series in dt^2, dt^3, dt^4, dt^5, so five runs remove these four terms.
LEVELS = (2, 3, 4, 6, 8)
powers = [[(2 / level) ** power for level in LEVELS] for power in (0, 2, 3, 4, 5)]
weights = np.linalg.solve(powers, [1, 0, 0, 0, 0])
end = weights @ [run(dt / level) for level in LEVELS]
print("rocker: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: rocker: x = 0.8234486517 m, y = 0.4221481755 m, angle = 2.2991675519 rad
