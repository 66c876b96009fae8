"""Slip 25: the acceleration of B relative to A."""

import numpy as np

length, phi, rate, turn = 0.7, -1.1, 3.0, 0.6  # bar AB: its length, phi2, its rate, its second rate


def end(t):
    angle = phi + rate * t + turn * t**2 / 2
    return length * np.array([np.sin(angle), -np.cos(angle)])


r, k_cross_r = end(0.0), length * np.array([np.cos(phi), np.sin(phi)])
printed = rate * k_cross_r - rate**2 * r  # omega x r + omega x (omega x r)
right = turn * k_cross_r - rate**2 * r
h = 1e-3
measured = (-end(2 * h) + 16 * end(h) - 30 * end(0) + 16 * end(-h) - end(-2 * h)) / (12 * h**2)
print(printed, right, measured)
