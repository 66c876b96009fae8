"""A belt as a gear of ratio 1 on a moving arm, after https://github.com/bulletphysics/bullet3/issues/3283 (in mm)."""

import math

import pymunk

space = pymunk.Space()
space.gravity = (0, -9810)
arm = pymunk.Body(0.6, 0.6 * 220**2 / 12)
arm.position = (110 * math.cos(0.4), 110 * math.sin(0.4))
arm.angle = 0.4
first = pymunk.Body(0.3, 0.3 * 40**2 / 2)
second = pymunk.Body(0.5, 0.5 * 55**2 / 2)
second.position = (220 * math.cos(0.4), 220 * math.sin(0.4))
tool = pymunk.Body(0.2, 0.2 * 90**2 / 12)
tool.position = second.position.x + 45, second.position.y
space.add(arm, first, second, tool)
s = space.static_body
space.add(pymunk.PivotJoint(s, arm, (0, 0)), pymunk.PivotJoint(s, first, (0, 0)))
space.add(pymunk.PivotJoint(arm, second, second.position), pymunk.PivotJoint(second, tool, second.position))
space.add(pymunk.GearJoint(first, second, 0, 1), pymunk.GearJoint(second, tool, 0, 1))
space.add(pymunk.DampedRotarySpring(s, first, 0, 60000, 900))
first.angular_velocity = 0
