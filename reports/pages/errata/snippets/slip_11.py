"""Slip 11: the acceleration of a point of a body on a skate."""

import numpy as np

heading, rate, turn = 0.7, 1.7, -0.6  # theta, thetadot, thetaddot
speed, push, (p, q) = 1.3, 0.4, (0.35, -0.2)  # v_C, its derivative, and G in the body's frame


def axes(t):
    angle = heading + rate * t + turn * t**2 / 2
    return np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])


def velocity(t):
    i, j = axes(t)
    return (speed + push * t) * i + (rate + turn * t) * (p * j - q * i)  # v_C i' + thetadot k x r


i, j = axes(0.0)
r, k_cross_r = p * i + q * j, p * j - q * i
rest = push * i + turn * k_cross_r - rate**2 * r
printed = rest + speed * axes(1e-20j)[1].imag / 1e-20  # v_C d(j')/dt, literally
right = rest + speed * axes(1e-20j)[0].imag / 1e-20  # v_C d(i')/dt = v_C thetadot j'
measured = velocity(1e-20j).imag / 1e-20
print(printed, right, measured)
