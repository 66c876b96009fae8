#!/usr/bin/env bash
# pymunk 7.3.1: GearJoint and RotaryLimitJoint measure the angle of body b relative to body a. SimpleMotor and DampedRotarySpring
# measure the angle of a relative to b, so a positive rate or rest angle turns b backwards. The documentation calls both "relative
# angle". One would expect the same convention for all four constraints.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/environment"
"$folder/environment/bin/python" -m pip install --quiet --disable-pip-version-check pymunk==7.3.1
"$folder/environment/bin/python" - <<'PYTHON'
import math

import pymunk


def rest(constraint, seconds=20):
    """The angle and the rate of body b after some time, with body a fixed and all motion damped."""
    space = pymunk.Space()
    space.damping = 0.2
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0)), constraint(space.static_body, body))
    for _ in range(240 * seconds):
        space.step(1 / 240)
    return body.angle, body.angular_velocity


print(f"pymunk {pymunk.version}: body a is fixed, body b turns")
gear, _ = rest(lambda a, b: pymunk.GearJoint(a, b, phase=0.5, ratio=1))
limit, _ = rest(lambda a, b: pymunk.RotaryLimitJoint(a, b, 0.5, 0.6))
spring, _ = rest(lambda a, b: pymunk.DampedRotarySpring(a, b, rest_angle=0.5, stiffness=10, damping=1))
_, rate = rest(lambda a, b: pymunk.SimpleMotor(a, b, rate=5))
print(f"GearJoint, phase 0.5: {gear:+.3f} rad; RotaryLimitJoint 0.5 to 0.6: {limit:+.3f} rad")
print(f"DampedRotarySpring, rest_angle 0.5: {spring:+.3f} rad; SimpleMotor, rate 5: {rate:+.3f} rad/s")
assert math.isclose(gear, 0.5, rel_tol=1e-3) and 0.5 <= limit <= 0.6, "gear or limit have changed"
assert math.isclose(spring, -0.5, rel_tol=1e-3) and math.isclose(rate, -5, rel_tol=1e-3), "spring or motor have changed"
PYTHON
