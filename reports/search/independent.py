"""The motion of a planar mechanism with ideal joints, by numpy and scipy alone: what a script can carry along.

Bodies, joints and force elements are whatever has the names and numbers of `reference.joints` and `reference.forces`;
their classes tell what they are. It shares no code with them, nor with the judge.
"""

import numpy as np
from scipy.integrate import solve_ivp


def turned(angle, point):
    """A vector (2,) turned by an angle [rad]; either may be complex, for a complex step."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])


def on_curve(curve, angle):
    """The point of a boundary, its material on the left, where it is traversed in this direction [rad]."""
    outward = np.array([np.sin(angle), -np.cos(angle)])
    match type(curve).__name__:
        case "Placed":
            return turned(curve.turn, on_curve(curve.curve, angle - curve.turn)) + curve.shift
        case "Circle":
            return curve.centre + curve.radius * outward
        case "Ring":
            return curve.centre - curve.radius * outward
    squares = np.array([curve.along_x, curve.along_y]) ** 2  # an ellipse
    return squares * outward / np.sqrt(squares @ outward**2)


class Motion:
    """Newton's law M a = f + J^T multipliers with J a = -J' v; J' v by a complex step along the velocities."""

    def __init__(self, bodies, joints, gravity, forces, tangents):
        """`tangents`: by a Roll's name how the first's boundary is traversed [rad] where curves touch at the start."""
        self.bodies, self.joints, self.gravity, self.forces = bodies, joints, gravity, forces
        self.tangents = dict(tangents)
        self.place = {None: -1} | {body.name: index for index, body in enumerate(bodies)}
        self.masses = np.array([[body.mass, body.mass, body.inertia] for body in bodies]).ravel()

    def pose(self, q, name):
        index = self.place[name]
        return q[3 * index : 3 * index + 3] if name else np.zeros(3, dtype=q.dtype)

    def at(self, q, name, point):
        x = self.pose(q, name)
        return x[:2] + turned(x[2], point)

    def moves(self, q, name, place):
        """How a body's material at a place of the world moves: (2, 3 bodies)."""
        rows = np.zeros((2, len(q)), dtype=q.dtype)
        if name:
            arm = place - self.pose(q, name)[:2]
            rows[:, 3 * self.place[name] : 3 * self.place[name] + 3] = [[1, 0, -arm[1]], [0, 1, arm[0]]]
        return rows

    def turns(self, q, name):
        row = np.zeros((1, len(q)), dtype=q.dtype)
        if name:
            row[0, 3 * self.place[name] + 2] = 1
        return row

    def contact(self, q, roll):
        """Where the curves of a Roll touch, in the world."""
        ground, body, first = roll.rolling.ground, roll.rolling.body, self.pose(q, roll.first)
        angle = self.pose(q, roll.second)[2] - first[2]

        def touching(tangent):
            return self.at(q, roll.second, on_curve(body, tangent + np.pi - angle))

        if type(ground).__name__ == "Line":
            return touching(ground.heading)

        def apart(tangent):
            there = self.at(q, roll.first, on_curve(ground, tangent))
            return (touching(tangent) - there) @ turned(first[2], [np.cos(tangent), np.sin(tangent)])

        tangent = self.tangents[roll.name]
        for _ in range(20):
            slope = (apart(tangent + 1e-6) - apart(tangent - 1e-6)) / 2e-6
            tangent = tangent - apart(tangent) / slope
        self.tangents[roll.name] = float(np.real(tangent))
        return touching(tangent)

    def rows(self, q, joint):
        """Velocities that a joint holds at a value."""
        first, second = joint.first, joint.second
        turning = self.turns(q, second) - getattr(joint, "ratio", 1.0) * self.turns(q, first)
        kind = type(joint).__name__
        if kind in ("Drive", "Gear"):
            return turning
        if kind == "Roll":
            place = self.contact(q, joint)
            return self.moves(q, second, place) - self.moves(q, first, place)
        place = self.at(q, second, joint.second_point)
        if kind in ("Slot", "Skate"):
            line = self.pose(q, first if kind == "Slot" else second)[2]
            line = line + (joint.line_angle if kind == "Slot" else joint.angle)
            across = np.array([-np.sin(line), np.cos(line)])
            return (across @ (self.moves(q, second, place) - self.moves(q, first, place)))[None]
        other = self.at(q, first, joint.first_point)
        rows = self.moves(q, second, place) - self.moves(q, first, other)
        if kind == "Rod":
            return ((place - other) / np.sqrt(np.sum((place - other) ** 2)) @ rows)[None]
        return np.vstack([rows, turning]) if kind == "Weld" else rows

    def pushed(self, q, v, force):
        """The generalised force (3 bodies,) of a force element."""
        kind, turning = type(force).__name__, self.turns(q, force.second)[0]
        if kind == "Force":
            return np.array(force.force) @ self.moves(q, force.second, self.at(q, force.second, force.second_point))
        turning = turning - self.turns(q, force.first)[0]
        match kind:
            case "Torque":
                return force.torque * turning
            case "TorsionSpring":
                return -force.stiffness * (turning @ q - force.rest_angle) * turning
            case "TorsionDamper":
                return -force.damping * (turning @ v) * turning
        place, other = self.at(q, force.second, force.second_point), self.at(q, force.first, force.first_point)
        along = (place - other) @ (self.moves(q, force.second, place) - self.moves(q, force.first, other))
        length = np.sqrt(np.sum((place - other) ** 2))
        if kind == "Damper":
            return -force.damping * (along @ v) / length**2 * along
        return -force.stiffness * (1 - (force.rest_length / length if force.rest_length else 0.0)) * along

    def acceleration(self, q, v):
        free = np.tile([*self.gravity, 0.0], len(self.bodies))
        free = free + sum((self.pushed(q, v, force) for force in self.forces), np.zeros(len(q))) / self.masses
        if not self.joints:
            return free
        rows = np.vstack([self.rows(q, joint) for joint in self.joints])
        step = 1e-20
        turning = np.vstack([self.rows(q + 1j * step * v, joint) for joint in self.joints]).imag / step @ v
        root = np.sqrt(self.masses)
        return free + np.linalg.lstsq(rows / root, -turning - rows @ free, rcond=1e-13)[0] / root

    def after(self, seconds):
        """Poses (bodies, 3) after so many seconds."""
        q, v = (np.array([getattr(body, name) for body in self.bodies]).ravel() for name in ("pose", "twist"))

        def slope(t, state):
            q, v = np.split(state, 2)
            return np.concatenate([v, self.acceleration(q, v)])

        size = np.concatenate([np.full(len(q), np.abs(q).max()), np.full(len(v), np.abs(v).max() + 1e-3)])
        told = solve_ivp(slope, (0, seconds), np.concatenate([q, v]), "DOP853", rtol=1e-12, atol=1e-13 * size + 1e-300)
        return told.y[: len(q), -1].reshape(-1, 3)
