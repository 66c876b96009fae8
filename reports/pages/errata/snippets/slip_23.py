"""Slip 23: the acceleration of A in the double pendulum."""

import numpy as np

length, phi, rate, turn = 0.7, 0.4, 2.0, -5.0  # bar OA: its length, phi1, its rate, its second rate


def end(t):
    angle = phi + rate * t + turn * t**2 / 2
    return length * np.array([np.sin(angle), -np.cos(angle)])


r, k_cross_r = end(0.0), length * np.array([np.cos(phi), np.sin(phi)])
printed = rate * k_cross_r - rate**2 * r  # omega x r + omega x (omega x r)
right = turn * k_cross_r - rate**2 * r
h = 1e-3
measured = (-end(2 * h) + 16 * end(h) - 30 * end(0) + 16 * end(-h) - end(-2 * h)) / (12 * h**2)
print(printed, right, measured)
