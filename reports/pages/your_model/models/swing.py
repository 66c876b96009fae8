import pymunk

space = pymunk.Space()
space.gravity = (0, -9.81)
seat = pymunk.Body(mass=2, moment=0.2)
seat.position = (0.8, -0.6)
leg = pymunk.Body(mass=1, moment=0.05)
leg.position = (1.1, -0.6)
space.add(
    seat,
    leg,
    pymunk.PinJoint(space.static_body, seat, (0, 0), (0, 0)),
    pymunk.PivotJoint(seat, leg, (0.1, 0), (-0.2, 0)),
    pymunk.DampedRotarySpring(seat, leg, rest_angle=0, stiffness=5, damping=0.1),
)
