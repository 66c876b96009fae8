"""Sleigh in pymunk by the method *tuned*: a groove that our code sets before each step."""

import math

import pymunk

duration = 3.0  # s
steps = 300
dt = duration / steps  # s
BLADE = -0.5  # m, position on the body's x axis, behind the centre of mass

space = pymunk.Space()
space.iterations = 5
body = pymunk.Body(mass=2, moment=0.3)
body.position, body.velocity, body.angular_velocity = (0.5, 0), (1, 1), 2
groove = pymunk.GrooveJoint(space.static_body, body, (-1, 0), (1, 0), (BLADE, 0))
groove.error_bias = 0  # each step closes the whole gap
space.add(body, groove)


def aim():
    """Set the groove to the direction of the blade after this step: pymunk moves bodies before it applies joints."""
    angle = body.angle + body.angular_velocity * dt
    centre = body.position + body.velocity * dt
    along = pymunk.Vec2d(math.cos(angle), math.sin(angle))
    groove.groove_a, groove.groove_b = centre + (BLADE - 1) * along, centre + (BLADE + 1) * along


for _ in range(steps):
    aim()
    space.step(dt)
end = body.position.x, body.position.y, body.angle
print("sleigh: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: sleigh: x = 2.7696089798 m, y = 4.1825116239 m, angle = 1.1378398769 rad
