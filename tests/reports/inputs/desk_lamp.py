"""A desk lamp with a pivot and a limit of 0 to 0 as a fixed joint, after https://github.com/viblo/pymunk/issues/232."""

import pymunk

space = pymunk.Space()
space.gravity = (0, -981)


def bar(p, q, mass):
    b = pymunk.Body(mass, mass * ((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2) / 12)
    b.position = (p[0] + q[0]) / 2, (p[1] + q[1]) / 2
    space.add(b)
    return b


s = space.static_body
low, high = bar((0, 0), (60, 45), 1), bar((0, 20), (60, 65), 1)
post = bar((60, 45), (60, 65), 0.5)
lamp = bar((60, 65), (95, 75), 0.7)
for a, b, at in ((s, low, (0, 0)), (s, high, (0, 20)), (low, post, (60, 45)), (high, post, (60, 65))):
    space.add(pymunk.PivotJoint(a, b, at))
space.add(pymunk.PivotJoint(post, lamp, (60, 65)), pymunk.RotaryLimitJoint(post, lamp, 0, 0))
space.add(pymunk.DampedSpring(s, low, (0, 60), (10, 7.5), 40, 250, 1.5))
