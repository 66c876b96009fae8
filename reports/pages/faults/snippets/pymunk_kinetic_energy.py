from importlib.metadata import version

import pymunk

body = pymunk.Body(mass=2, moment=3)
body.velocity = 1, 0
body.angular_velocity = 1
expected = 2.5  # J: m v^2 / 2 + I omega^2 / 2
found = body.kinetic_energy
print(f"pymunk {version('pymunk')}: expected {expected!r}, found {found!r}")
