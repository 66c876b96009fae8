"""The chapter's pseudocode for the four-bar: rates integrated as printed. A method under test, not a reference.

Nothing in it holds the loop closed, so every error in the angles stays and feeds the next: with the common default
tolerance (rtol 1e-3) the coupler's angle is off by 0.02 rad after one revolution, and by a radian after a hundred.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import BDF, DOP853, LSODA, RK23, RK45, Radau

from reference.checks import Count, InvalidMechanism, Positive, shown, validated
from reference.kinds import of_shape

Array = NDArray[np.float64]
ADAPTIVE: dict[str, Any] = {"RK45": RK45, "RK23": RK23, "DOP853": DOP853, "Radau": Radau, "BDF": BDF, "LSODA": LSODA}
FIXED = {"euler": (0.0,), "rk4": (0.0, 0.5, 0.5, 1.0)}  # where each stage stands in its step
Method = Literal["euler", "rk4", "RK45", "RK23", "DOP853", "Radau", "BDF", "LSODA"]


class RateIntegration(NamedTuple):
    """Angles [rad] at times t [s], NaN after the method gave up; the evaluations it took; why it stopped, or ''."""

    t: Array
    theta: Array
    beta: Array
    phi: Array
    evaluations: int
    stopped: str


@validated
def integrate_rates(
    lengths: tuple[Positive, Positive, Positive],
    start: tuple[float, float, float],
    theta_dot: float,
    t: Annotated[Array, of_shape("times")],
    method: Method = "RK45",
    rtol: Positive = 1e-3,
    atol: Positive = 1e-6,
    every: Count = 10,
    limit: Count = 100_000,
) -> RateIntegration:
    """Integrate (theta, beta, phi) from `start` at t[0] with the rates (18.70), (18.71) and theta' constant.

    lengths l1, l2, l3 [m]; theta_dot [rad/s]; t [s] increasing. "euler" and "rk4" take `every` steps between samples;
    scipy's RK45, RK23, DOP853, Radau, BDF and LSODA choose theirs by rtol and atol, as solve_ivp does. After `limit`
    evaluations, or where scipy's method fails, it stops and says so: near sin(beta - phi) = 0, which drift reaches even
    for a crank that turns fully, the steps shrink without end. Raises InvalidMechanism, a ValueError.
    """
    times = t
    if times.size < 2 or not np.all(np.diff(times) > 0):
        raise InvalidMechanism(f"rate integration: t is {shown(t)}; it must be a row of at least two increasing times")
    l1, l2, l3 = lengths

    def odes(_: float, angles: Array) -> Array:
        theta, beta, phi = (float(value) for value in angles)
        closing = math.sin(beta - phi) or math.nan
        return np.array(
            [
                theta_dot,
                (l1 / l2) * math.sin(phi - theta) / closing * theta_dot,
                (l1 / l3) * math.sin(beta - theta) / closing * theta_dot,
            ]
        )

    out = np.full((times.size, 3), np.nan)
    out[0] = start
    if method in ADAPTIVE:
        solver = ADAPTIVE[method](odes, times[0], out[0].copy(), times[-1], rtol=rtol, atol=atol)
        evaluations, stopped = _adaptive(solver, times, out, limit)
    else:
        evaluations, stopped = _fixed(odes, FIXED[method], times, out, every, limit)
    return RateIntegration(times, out[:, 0], out[:, 1], out[:, 2], evaluations, stopped)


def _adaptive(solver: Any, times: Array, out: Array, limit: int) -> tuple[int, str]:
    done = 1
    while solver.status == "running":
        if solver.nfev >= limit:
            return solver.nfev, f"stopped at t = {solver.t:.6g} s after {solver.nfev} evaluations"
        with np.errstate(all="ignore"):
            message = solver.step()
        if solver.status == "failed":
            return solver.nfev, f"failed at t = {solver.t:.6g} s: {message}"
        reached = int(np.searchsorted(times, solver.t, side="right"))
        if reached > done:
            out[done:reached] = solver.dense_output()(times[done:reached]).T
            done = reached
    return solver.nfev, ""


def _fixed(
    odes: Callable[[float, Array], Array], nodes: tuple[float, ...], times: Array, out: Array, every: int, limit: int
) -> tuple[int, str]:
    """Steps of Euler's method or the classical one of Runge and Kutta, whose stages follow from one another."""
    evaluations, weights = 0, np.array([1.0] if len(nodes) == 1 else [1 / 6, 1 / 3, 1 / 3, 1 / 6])
    for index in range(1, times.size):
        angles, step = out[index - 1], (times[index] - times[index - 1]) / every
        for _ in range(every):
            if evaluations + len(nodes) > limit:
                return evaluations, f"stopped at t = {times[index - 1]:.6g} s after {evaluations} evaluations"
            slopes = [np.zeros(3)]
            for node in nodes:
                slopes.append(odes(0.0, angles + step * node * slopes[-1]))  # the rates don't depend on time
            angles = angles + step * (weights @ np.array(slopes[1:]))
            evaluations += len(nodes)
        out[index] = angles
        if not np.all(np.isfinite(angles)):
            return evaluations, f"failed before t = {times[index]:.6g} s: the rates are not finite"
    return evaluations, ""
