"""A chain with a heavy load stretches, after https://github.com/schteppe/p2.js/issues/164 (in pixels)."""

import pymunk

space = pymunk.Space()
space.gravity = (0, -981)
last, links = space.static_body, []
for k in range(6):
    b = pymunk.Body(2, pymunk.moment_for_box(2, (30, 8)))
    b.position = (15 + 30 * k, 0)
    space.add(b)
    space.add(pymunk.PivotJoint(last, b, (30 * k, 0) if last is space.static_body else (15, 0), (-15, 0)))
    last = b
    links.append(b)
ball = pymunk.Body(40, pymunk.moment_for_circle(40, 0, 20))
ball.position = (200, 0)
space.add(ball)
space.add(pymunk.PinJoint(last, ball, (15, 0), (0, 0)))
