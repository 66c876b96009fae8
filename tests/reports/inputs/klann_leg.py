"""A leg that falls apart, after https://github.com/JuliaRobotics/RigidBodyDynamics.jl/issues/480."""

import math

import pymunk

space = pymunk.Space()
space.gravity = (0.0, -9.81)
ground = space.static_body


def meet(p, rp, q, rq, side):
    d = math.dist(p, q)
    u = (rp * rp - rq * rq + d * d) / (2 * d)
    v = side * math.sqrt(rp * rp - u * u)
    ex, ey = (q[0] - p[0]) / d, (q[1] - p[1]) / d
    return (p[0] + u * ex - v * ey, p[1] + u * ey + v * ex)


AXLE, A, B = (0.0, 0.0), (-0.64, -0.14), (-0.62, 0.86)  # crank axle, lower and upper rocker pivots
phi = 0.9
M = (0.22 * math.cos(phi), 0.22 * math.sin(phi))
C = meet(A, 0.40, M, 0.58, 1)  # lower rocker with the connecting plate
k = math.atan2(C[1] - M[1], C[0] - M[0])
D = (C[0] + 0.52 * math.cos(k - 0.12), C[1] + 0.52 * math.sin(k - 0.12))
E = meet(B, 0.56, D, 0.72, -1)  # upper rocker with the leg
j = math.atan2(D[1] - E[1], D[0] - E[0])
F = (D[0] + 0.95 * math.cos(j + 0.3), D[1] + 0.95 * math.sin(j + 0.3))


def plate(*points):
    sides = [(points[i], points[(i + 1) % len(points)]) for i in range(len(points) if len(points) > 2 else 1)]
    mass = sum(3 * math.dist(*s) for s in sides)
    c = tuple(sum(3 * math.dist(*s) * (s[0][i] + s[1][i]) / 2 for s in sides) / mass for i in (0, 1))
    moment = sum(
        3
        * math.dist(*s)
        * (math.dist(*s) ** 2 / 12 + math.dist(c, ((s[0][0] + s[1][0]) / 2, (s[0][1] + s[1][1]) / 2)) ** 2)
        for s in sides
    )
    body = pymunk.Body(mass, moment)
    body.position = c
    space.add(body)
    return body


crank, plate_1, lower, upper, leg = plate(AXLE, M), plate(M, C, D), plate(A, C), plate(B, E), plate(E, D, F)
for a, b, at in (
    (ground, crank, AXLE),
    (crank, plate_1, M),
    (ground, lower, A),
    (lower, plate_1, C),
    (plate_1, leg, D),
    (ground, upper, B),
    (upper, leg, E),
):
    joint = pymunk.PivotJoint(a, b, at)
    joint.collide_bodies = False
    space.add(joint)
space.add(pymunk.SimpleMotor(ground, crank, 3.2))
