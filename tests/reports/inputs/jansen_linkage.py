"""One leg of Jansen's, of his eleven lengths in centimetres, without a motor."""

import math

import pymunk

# Jansen's eleven lengths; one leg, crank from the centre AXLE, fixed point F
a, b, c, d, e, f, g, h, i, j, k, low, m = 38.0, 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 65.7, 49.0, 50.0, 61.9, 7.8, 15.0
S = 0.01


def meet(p, rp, q, rq, side):
    dx, dy = q[0] - p[0], q[1] - p[1]
    D = math.hypot(dx, dy)
    u = (rp * rp - rq * rq + D * D) / (2 * D)
    v = math.sqrt(rp * rp - u * u) * side
    return p[0] + u * dx / D - v * dy / D, p[1] + u * dy / D + v * dx / D


AXLE, F = (0.0, 0.0), (-a, -low)
th = 0.5
C = (m * math.cos(th), m * math.sin(th))
U = meet(F, b, C, j, 1)  # upper joint: b from the fixed point, j from the crank
W = meet(F, d, U, e, 1)  # upper triangle b, d, e
K = meet(F, c, C, k, 1)  # lower: c and k
V = meet(W, f, K, g, -1)  # f and g
T = meet(K, i, V, h, 1)  # foot triangle g, h, i


def sc(p):
    return p[0] * S, p[1] * S


space = pymunk.Space()
space.gravity = (0, -9.81)
ground = space.static_body


def body(points, names):
    cx, cy = sum(p[0] for p in points) / len(points), sum(p[1] for p in points) / len(points)
    size = max(math.dist(p, q) for p in points for q in points) * S
    mass = 2 * size
    B = pymunk.Body(mass, mass * size * size / 12)
    B.position = sc((cx, cy))
    space.add(B)
    return B


def pin(A, B, p):
    p = sc(p)
    space.add(pymunk.PivotJoint(A, B, A.world_to_local(p), B.world_to_local(p)))


crank = body([AXLE, C], "OC")
rod_j, rod_k, rod_c, rod_f = body([C, U], "j"), body([C, K], "k"), body([F, K], "c"), body([W, V], "f")
upper, lower = body([F, U, W], "bde"), body([K, V, T], "ghi")
pin(ground, crank, AXLE)
pin(crank, rod_j, C)
pin(crank, rod_k, C)
pin(rod_j, upper, U)
pin(ground, upper, F)
pin(rod_k, lower, K)
pin(ground, rod_c, F)
pin(rod_c, lower, K)
pin(upper, rod_f, W)
pin(rod_f, lower, V)
