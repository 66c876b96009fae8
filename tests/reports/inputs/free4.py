"""A four-bar of a game, in pixels, that swings freely."""

import pymunk

space = pymunk.Space()
space.gravity = (0, -900)


def bar(p, q):
    b = pymunk.Body(
        1,
        pymunk.moment_for_segment(1, ((p[0] - q[0]) / 2, (p[1] - q[1]) / 2), ((q[0] - p[0]) / 2, (q[1] - p[1]) / 2), 2),
    )
    b.position = (p[0] + q[0]) / 2, (p[1] + q[1]) / 2
    space.add(b)
    return b


A, B, C, D = (0, 0), (0, 50), (120, 90), (110, 0)
crank, coupler, rocker = bar(A, B), bar(B, C), bar(C, D)
for a, b, at in (
    (space.static_body, crank, A),
    (crank, coupler, B),
    (coupler, rocker, C),
    (space.static_body, rocker, D),
):
    space.add(pymunk.PivotJoint(a, b, at))
