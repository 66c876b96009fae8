"""Pendulum 2 in pymunk, as the method *tuned* does it."""

import pymunk

duration = 2.0  # s
steps = 2000
dt = duration / steps  # s

# Mass [kg], moment of inertia [kg m^2], centre of mass [m], angle [rad], velocity [m/s], rate [rad/s].
BODIES = {
    "link 1": (1, 0.0833333333333, (0.5, 0), 0, (0, 0), 0),
    "link 2": (1, 0.0833333333333, (1.5, 0), 0, (0, 0), 0),
}
# Two points [m] that are one, each from the centre of mass of its body; None is the ground.
PINS = [
    (None, (0, 0), "link 1", (-0.5, 0)),
    ("link 1", (0.5, 0), "link 2", (-0.5, 0)),
]


def run(dt):
    """Place and angle of the link 2 after `duration` in steps of dt."""
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
        joint.error_bias = 0  # close the whole gap in every step
        space.add(joint)
    for _ in range(round(duration / dt)):
        space.step(dt)
    body = bodies["link 2"]
    return body.position.x, body.position.y, body.angle


end = run(dt)
print("link 2: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: link 2: x = 0.1154304525 m, y = -1.4556620515 m, angle = -1.1634342519 rad
