from importlib.metadata import version

import pymunk

# A stone of 1 kg falls without spin. What it has lost of m g h is its kinetic energy.
space = pymunk.Space()
space.gravity = 0, -9.81
stone = pymunk.Body(1, 1)
space.add(stone)
print(f"pymunk {version('pymunk')}")
print(f"{'time [s]':>8}{'m g h lost [J]':>16}{'kinetic_energy [J]':>20}")
for second in (1, 2):
    for _ in range(10_000):
        space.step(1e-4)
    print(f"{second:8}{-9.81 * stone.position.y:16.2f}{stone.kinetic_energy:20.2f}")
