"""Slip 1: a circle of radius b rolls on one of radius a; how fast does the contact move?"""

import numpy as np

a, b = 0.8, 0.5
theta, rate, turn = 0.7, 1.7, -0.6  # of the rolling circle: angle, first and second derivative


def contact(t):
    angle = (theta + rate * t + turn * t**2 / 2) * b / (a + b)
    return a * np.array([np.cos(angle), np.sin(angle)])


at = theta * b / (a + b)
tangent = np.array([-np.sin(at), np.cos(at)])
printed = a * at * tangent  # s e_t
right = rate / (1 / a + 1 / b) * tangent  # sdot e_t
measured = contact(1e-20j).imag / 1e-20  # the derivative of the position, by a complex step
print(printed, right, measured)
