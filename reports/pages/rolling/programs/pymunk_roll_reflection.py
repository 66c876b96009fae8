"""An ellipse that rolls on level ground, in pymunk, as the method *roll: reflection* does it."""

import math

import pymunk

duration = 2.0  # s
steps = 200
dt = duration / steps  # s

MASS, MOMENT, LONG, SHORT, GRAVITY = 1, 0.085, 0.5, 0.3, 9.81  # kg, kg m^2, half axes in m, m/s^2


def run(dt):
    """Place and angle of the roller after `duration` in steps of dt."""
    space = pymunk.Space()  # without gravity and joints: it moves a free body, and the ground is ours
    body = pymunk.Body(MASS, MOMENT)
    body.position, body.velocity, body.angular_velocity = (0, SHORT), (-1.2, 0), 4
    space.add(body)
    for _ in range(round(duration / dt)):
        space.step(dt / 2)
        # The contact is the lowest point of the ellipse; `arm` goes from there to the centre.
        x, y = -math.sin(body.angle), -math.cos(body.angle)
        size = math.hypot(LONG * x, SHORT * y)
        arm = -pymunk.Vec2d(LONG**2 * x / size, SHORT**2 * y / size).rotated(body.angle)
        velocity = body.velocity - (0, GRAVITY * dt / 2)
        # Turning about the contact keeps the angular momentum about it. Twice that, less what was: a reflection.
        momentum = MOMENT * body.angular_velocity + MASS * arm.cross(velocity)
        turning = 2 * momentum / (MOMENT + MASS * arm.dot(arm))
        body.velocity = turning * arm.perpendicular() - velocity - (0, GRAVITY * dt / 2)
        body.angular_velocity = turning - body.angular_velocity
        space.step(dt / 2)
    return body.position.x, body.position.y, body.angle


end = run(dt)
print("roller: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
