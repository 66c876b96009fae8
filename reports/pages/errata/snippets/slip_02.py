"""Slip 2: which point of a rolling circle has no velocity?"""

import numpy as np

a, b = 0.8, 0.5
theta, rate, turn = 0.7, 1.7, -0.6


def place(t, point):
    """Where a point of the rolling circle is, given from its centre as it lies at t = 0."""
    turned = rate * t + turn * t**2 / 2
    angle = (theta + turned) * b / (a + b)
    x, y = point
    spin = np.array([x * np.cos(turned) - y * np.sin(turned), x * np.sin(turned) + y * np.cos(turned)])
    return (a + b) * np.array([np.cos(angle), np.sin(angle)]) + spin


def velocity(point):
    return place(1e-20j, point).imag / 1e-20


centre = place(0.0, (0.0, 0.0))
v = velocity((0.0, 0.0))
printed = velocity(-centre)  # of the body's point at r_C = 0
right = velocity(np.array([-v[1], v[0]]) / rate)  # of the one at k x v / omega
measured = np.zeros(2)  # what a pole has
print(printed, right, measured)
