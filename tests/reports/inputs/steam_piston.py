"""A steam piston with a groove that gives way, after https://github.com/godotengine/godot/pull/27462 (in mm)."""

import math

import pymunk

U = 1000.0
space = pymunk.Space()
space.gravity = 0, -9.81 * U


def body(mass, length, x, y, angle=0.0):
    b = pymunk.Body(mass, mass * (length * U) ** 2 / 12)
    b.position, b.angle = (x * U, y * U), angle
    space.add(b)
    return b


r, length, phi, off = 0.08, 0.3, 0.6, 0.02
P = (r * math.cos(phi), r * math.sin(phi))
X = P[0] + math.sqrt(length * length - (P[1] - off) ** 2)
wheel = pymunk.Body(4, 0.5 * 4 * (0.12 * U) ** 2)
space.add(wheel)
rod = body(0.7, length, (P[0] + X) / 2, (P[1] + off) / 2, math.atan2(off - P[1], X - P[0]))
head = pymunk.Body(1.3, float("inf"))
head.position = X * U, off * U
space.add(head)
s = space.static_body
space.add(
    pymunk.PivotJoint(s, wheel, (0, 0), (0, 0)),
    pymunk.PivotJoint(wheel, rod, (P[0] * U, P[1] * U)),
    pymunk.PivotJoint(rod, head, (X * U, off * U)),
)
space.add(pymunk.GrooveJoint(s, head, (0.15 * U, off * U), (0.5 * U, off * U), (0, 0)))
space.add(pymunk.DampedSpring(s, head, (0.55 * U, off * U), (0, 0), 0.1 * U, 900, 4))
w = 6.0
t = math.atan2(off - P[1], X - P[0])
wt = -r * w * math.cos(phi) / (length * math.cos(t))
wheel.angular_velocity = w
rod.angular_velocity = wt
head.velocity = (-r * w * math.sin(phi) - length * wt * math.sin(t)) * U, 0
rod.velocity = (
    (-r * w * math.sin(phi) - length / 2 * wt * math.sin(t)) * U,
    (r * w * math.cos(phi) + length / 2 * wt * math.cos(t)) * U,
)
