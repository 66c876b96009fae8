from importlib.metadata import version

import pymunk

# A free body that slides along a groove in the ground, exactly in it: the joint has nothing to do.
space = pymunk.Space()
body = pymunk.Body(mass=1, moment=1)
body.velocity = 1, 0
groove = pymunk.GrooveJoint(space.static_body, body, (-9, 0.3), (9, 0.3), (0.3, 0.3))
space.add(body, groove)
space.step(0.001)
expected = 0.0  # m/s, of the anchor across the groove
found = body.velocity_at_local_point((0.3, 0.3)).y
print(f"pymunk {version('pymunk')}: expected {expected!r}, found {found!r}")
