"""Person two feet in pymunk, as the method *default* does it."""

import pymunk

duration = 0.3  # s
steps = 300
dt = duration / steps  # s

# Mass [kg], moment of inertia [kg m^2], centre of mass [m], angle [rad], velocity [m/s], rate [rad/s].
BODIES = {
    "left shank": (3.4875, 0.058948724672, (0.0133977825401, 0.243725534496), 1.51588081742, (0, 0), 0),
    "left thigh": (7.5, 0.143838310793, (0.146311463562, 0.639725496361), 1.04181423671, (0, 0), 0),
    "trunk": (50.85, 3.17771821302, (0.271497842286, 1.11392779416), 1.47079632679, (0, 0), 0),
    "right thigh": (7.5, 0.143838310793, (0.260087855758, 0.615441238551), -1.46238050463, (0, 0), 0),
    "right shank": (3.4875, 0.058948724672, (0.378884420819, 0.211926056024), -1.05159694369, (0, 0), 0),
}
# Two points [m] that are one, each from the centre of mass of its body; None is the ground.
PINS = [
    (None, (0, 0), "left shank", (-0.2440935, 0)),
    ("left shank", (0.1864065, 0), "left thigh", (-0.24310125, 0)),
    ("left thigh", (0.18564875, 0), "trunk", (-0.315504, 0)),
    ("left thigh", (0.18564875, 0), "right thigh", (-0.18564875, 0)),
    ("right thigh", (0.24310125, 0), "right shank", (-0.1864065, 0)),
    (None, (0.5, 0), "right shank", (0.2440935, 0)),
]


def run(dt):
    """Place and angle of the trunk after `duration` in steps of dt."""
    space = pymunk.Space()
    space.gravity = (0, -9.81)
    bodies = {None: space.static_body}
    for name, (mass, moment, place, angle, velocity, rate) in BODIES.items():
        body = bodies[name] = pymunk.Body(mass, moment)
        body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, rate
        space.add(body)
    joints = [pymunk.PivotJoint(bodies[a], bodies[b], one, other) for a, one, b, other in PINS]
    space.add(*joints)
    for _ in range(round(duration / dt)):
        space.step(dt)
    body = bodies["trunk"]
    return body.position.x, body.position.y, body.angle


end = run(dt)
print("trunk: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: trunk: x = 0.2845902970 m, y = 0.7027151569 m, angle = 1.5201414546 rad
