"""A car and its trailer in pymunk, seen from above by the method *tuned*: each axle is a skate."""

import math

import pymunk

duration = 5.0  # s
steps = 1500
dt = duration / steps  # s

# Mass [kg], moment of inertia [kg m^2], centre of mass [m], angle [rad], velocity [m/s], rate [rad/s].
BODIES = {
    "car": (2, 0.5, (0.4, 0), 0, (1, 0.169117287495), 0.422793218738),
    "trailer": (1, 0.2, (-0.43553254041, -0.605825405879), 1.2, (0.270980326317, 0.198869311048), -1.2033494578),
}
HITCH = (-0.6, 0), (0.65, 0)  # m, on the car and on the trailer
# Body of an axle, its point [m] and steering angle [rad] in the body's frame.
AXLES = [("car", (0.6, 0), 0.4), ("car", (-0.4, 0), 0), ("trailer", (-0.15, 0), 0)]


def run(dt):
    """Return the position [m] and angle [rad] of the trailer after `duration` with the step dt."""
    space = pymunk.Space()
    space.iterations = 5
    bodies = {}
    for name, (mass, moment, place, angle, velocity, rate) in BODIES.items():
        body = bodies[name] = pymunk.Body(mass, moment)
        body.position, body.angle, body.velocity, body.angular_velocity = place, angle, velocity, rate
        space.add(body)
    grooves, joints = [], []
    for name, (x, y), steering in AXLES:
        # A wheel may be anywhere on its axle; here it is at the foot of the perpendicular from the centre of mass.
        along = x * math.cos(steering) + y * math.sin(steering)
        foot = along * math.cos(steering), along * math.sin(steering)
        groove = pymunk.GrooveJoint(space.static_body, bodies[name], (-1, 0), (1, 0), foot)
        grooves.append((groove, bodies[name], steering, along))
        joints.append(groove)
    joints.insert(1, pymunk.PivotJoint(bodies["car"], bodies["trailer"], *HITCH))
    for joint in joints:
        joint.error_bias = 0  # each step closes the whole gap
        space.add(joint)
    for _ in range(round(duration / dt)):
        for groove, body, steering, along in grooves:
            # The groove has the direction of the blade after this step: pymunk moves bodies before it applies joints.
            heading = pymunk.Vec2d(1, 0).rotated(body.angle + body.angular_velocity * dt + steering)
            middle = body.position + body.velocity * dt + along * heading
            groove.groove_a, groove.groove_b = middle - 2 * heading, middle + 2 * heading
        space.step(dt)
    body = bodies["trailer"]
    return body.position.x, body.position.y, body.angle


end = run(dt)
print("trailer: x = {:.10f} m, y = {:.10f} m, angle = {:.10f} rad".format(*end))
# Exact: trailer: x = 2.2443677333 m, y = 2.3562150480 m, angle = 1.5069367214 rad
