"""Slip 19: the angles of the four-bar, which are called impossible to write as functions of theta."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

l1, l2, l3, l4 = 0.4, 0.4 * 2**0.5, 0.8 * 2**0.5, 1.2
theta = 2.0 + 2 * np.pi  # more than a turn after the start


def rates(theta, angles):  # the chapter's pseudocode
    beta, phi = angles
    return [
        l1 / l2 * np.sin(phi - theta) / np.sin(beta - phi),
        l1 / l3 * np.sin(beta - theta) / np.sin(beta - phi),
    ]


printed = solve_ivp(rates, (np.pi / 2, theta), [np.pi / 4, 3 * np.pi / 4], rtol=1e-3, atol=1e-6).y[:, -1]

B, D = l1 * np.exp(1j * theta), l4 + 0j
d = abs(D - B)
beta = np.angle(D - B) + np.arccos((d**2 + l2**2 - l3**2) / (2 * d * l2))
right = np.array([beta, np.angle(B + l2 * np.exp(1j * beta) - D)])


def miss(beta):  # by how much the bar CD is too long
    return abs(B + l2 * np.exp(1j * beta) - D) - l3


found = brentq(miss, np.angle(D - B), np.angle(D - B) + np.pi, xtol=1e-15)
measured = np.array([found, np.angle(B + l2 * np.exp(1j * found) - D)])
print(printed, right, measured)
