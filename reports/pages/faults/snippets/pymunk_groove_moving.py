from importlib.metadata import version

import pymunk

# A groove in a body that can move; the other body slides along it, held at its centre of mass.
space = pymunk.Space()
first, second = pymunk.Body(mass=1, moment=1), pymunk.Body(mass=1, moment=1)
second.position = 1, 1
second.velocity = 1, 0
groove = pymunk.GrooveJoint(first, second, (-9, 1), (9, 1), (0, 0))
space.add(first, second, groove)
space.step(0.001)
expected = 0.0  # m/s, of the anchor across the groove
place = first.world_to_local(second.position)
found = (second.velocity - first.velocity_at_local_point(place)).dot(first.rotation_vector.perpendicular())
print(f"pymunk {version('pymunk')}: expected {expected!r}, found {found!r}")
