"""Legs with very stiff DampedRotarySprings, after https://github.com/viblo/pymunk/issues/241 (in pixels)."""

import pymunk

space = pymunk.Space()
space.gravity = (0, -900)
chassis = pymunk.Body(5, pymunk.moment_for_box(5, (120, 30)))
chassis.position = (400, 300)
space.add(chassis)
# The chassis rides on a vertical rail and may turn.
space.add(pymunk.GrooveJoint(space.static_body, chassis, (400, 100), (400, 600), (0, 0)))
space.add(pymunk.DampedSpring(space.static_body, chassis, (400, 500), (0, 0), 150, 160, 3))
legs = []
for side in (-1, 1):
    a = pymunk.Body(1, pymunk.moment_for_box(1, (80, 8)))
    b = pymunk.Body(0.8, pymunk.moment_for_box(0.8, (70, 6)))
    a.position = (400 + side * 100, 300)
    b.position = (400 + side * 140, 300 - 35)
    b.angle = 1.5707963267948966
    space.add(a, b)
    space.add(pymunk.PivotJoint(chassis, a, (400 + side * 60, 300)), pymunk.PivotJoint(a, b, (400 + side * 140, 300)))
    space.add(
        pymunk.DampedRotarySpring(chassis, a, 0.15 * side, 4e6, 2e4),
        pymunk.DampedRotarySpring(a, b, -1.5707963267948966, 9e5, 8e3),
    )
    legs += [a, b]
