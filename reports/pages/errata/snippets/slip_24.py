"""Slip 24: what equals phi1ddot k?"""

import numpy as np

phi, rate, turn = 0.4, 2.0, -5.0


def angle(t):
    return np.array([phi + rate * t + turn * t**2 / 2])


printed = angle(1e-20j).imag / 1e-20  # omega
right = np.array([turn])  # omegadot
h = 1e-3
measured = (-angle(2 * h) + 16 * angle(h) - 30 * angle(0) + 16 * angle(-h) - angle(-2 * h)) / (12 * h**2)
print(printed, right, measured)
