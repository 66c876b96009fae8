from importlib.metadata import version
from math import cos, sin

import pymunk

# A bar of 1 kg and 1 m hangs by its end in a level groove and swings from 45 degrees. Its centre of mass, with no force
# along the groove, stays below one place, so that l = 0.5 m and the angle from the vertical tell all of it.
G, L, INERTIA, START = 9.81, 0.5, 1 / 12, 0.785


def exact(seconds, h=1e-3):
    """Angle and the groove's force at every h, by Runge and Kutta's method of fourth order."""

    def turning(a, w):
        return -L * sin(a) * (G + L * cos(a) * w * w) / (INERTIA + (L * sin(a)) ** 2)

    a, w, found = START, 0.0, []
    for _ in range(round(seconds / h) + 1):
        found.append((a, G + L * (cos(a) * w * w + sin(a) * turning(a, w))))
        k1, j1 = w, turning(a, w)
        k2, j2 = w + h / 2 * j1, turning(a + h / 2 * k1, w + h / 2 * j1)
        k3, j3 = w + h / 2 * j2, turning(a + h / 2 * k2, w + h / 2 * j2)
        k4, j4 = w + h * j3, turning(a + h * k3, w + h * j3)
        a, w = a + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), w + h / 6 * (j1 + 2 * j2 + 2 * j3 + j4)
    return found


def run(dt, **settings):
    """The largest errors over 2 s: angle [rad], gap [m]; energy of that of the swing, force of the largest."""
    space = pymunk.Space()
    space.gravity = 0, -G
    bar = pymunk.Body(1, INERTIA)
    bar.position, bar.angle = (0, -L * cos(START)), START
    groove = pymunk.GrooveJoint(space.static_body, bar, (-9, 0), (9, 0), (0, L))
    for name, value in settings.items():
        setattr(groove, name, value)
    space.add(bar, groove)
    truth, worst = exact(2.0), [0.0] * 4
    for angle, force in truth[1:]:
        for _ in range(round(1e-3 / dt)):
            space.step(dt)
        energy = (bar.velocity.length**2 + INERTIA * bar.angular_velocity**2) / 2 + G * bar.position.y
        now = (
            abs(bar.angle - angle),
            abs(bar.local_to_world((0, L)).y),
            abs(energy + G * L * cos(START)) / (G * L * (1 - cos(START))),
            abs(groove.impulse / dt - force) / max(each for _, each in truth),
        )
        worst = [max(pair) for pair in zip(worst, now, strict=True)]
    return worst


print(f"pymunk {version('pymunk')}")
print(f"{'':16}{'step [s]':>9}{'angle [rad]':>13}{'gap [m]':>10}{'energy':>10}{'force':>10}")
for label, settings in (("as shipped", {}), ("error_bias = 0", {"error_bias": 0})):
    for dt in (1e-3, 1e-4):
        errors = run(dt, **settings)
        print(f"{label:16}{dt:9.0e}{errors[0]:13.1e}" + "".join(f"{each:10.1e}" for each in errors[1:]))
