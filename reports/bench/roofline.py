"""Floating-point operations and bytes of a step of the judge, compared with this machine's peaks.

Operations are counted by formula from the loops of `engines/lagrange/compiled`. Bytes are those of the arrays that the
loops read or write, whether or not the arrays are in a cache. The peaks are measured by loops of independent fused
multiply-adds in registers, and by the addition of two arrays of the judge's size.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numba import njit

from engines.lagrange import Lagrange
from engines.lagrange.compiled.solve import FEW_ROWS
from engines.lagrange.compiled_model import CompiledModel
from engines.lagrange.running import FIXED_STEP_TABLEAUS
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.pendulum.scenes import LongPendulum
from reports.bench.times import least

# Operations for a body (a sine and a cosine of 20 each), a pin (arms, gaps and biases), a row (its right side and its
# reaction on two bodies), and a product of two ends of rows.
BODY_WORK, PIN_WORK, ROW_WORK, PRODUCT_WORK = 43, 34, 24, 6
# A projection close to the joints has two iterations for the pose and one solution for the twist.
PROJECTIONS = 3
LANES, ROUNDS = 64, 20_000
TURNS = 5
STEPS = 200


def evaluation_work(model: CompiledModel) -> tuple[float, float]:
    """The operations and bytes of an evaluation of accelerations in a mechanism with pins alone.

    With c couplings of a row to later rows, a factorisation takes c (c + 2) operations for the row, and a solution 4 c.
    The mean of c is used for all rows.
    """
    system = model.system
    rows, solutions = len(system.rows), 2 if len(system.rows) > FEW_ROWS else 1
    couplings = len(system.matrix) / rows - 1
    work = BODY_WORK * (len(system.bodies) - 1) + PIN_WORK * len(system.joints) + PRODUCT_WORK * len(system.products)
    work += rows * (couplings * (couplings + 2) + solutions * (4 * couplings + ROW_WORK))
    once = (system.bodies, system.joints, system.rows, system.products, system.right)
    twice = (system.equations, system.ends, system.inverse_pivots, system.reaction, system.change)
    passes = 2 + 2 * solutions  # assembled, factorised, and read twice in a solution
    moved = sum(array.nbytes for array in once) + 2 * sum(array.nbytes for array in twice)
    return work, moved + passes * system.matrix.nbytes


def step_work(model: CompiledModel, integrator: str) -> tuple[float, float]:
    """The operations and bytes of a fixed step with a projection."""
    tableau: Any = FIXED_STEP_TABLEAUS[integrator]
    work, moved = evaluation_work(model)
    evaluations = len(tableau.nodes) + PROJECTIONS
    sums = int(np.count_nonzero(tableau.stages)) + len(tableau.weights)
    coordinates = len(model.system.change)
    return evaluations * work + 4 * sums * coordinates, evaluations * moved + 48 * sums * coordinates


@njit(fastmath=True)
def _multiply_adds(values: Any, rounds: int) -> float:
    for _ in range(rounds):
        for k in range(LANES):
            values[k] = values[k] * 0.999999 + 1e-6
    return values[0]


@njit(fastmath=True)
def _additions(out: Any, first: Any, second: Any, rounds: int) -> None:
    for _ in range(rounds):
        for k in range(len(out)):
            out[k] = first[k] + second[k]


def peak_operations() -> float:
    """Operations per second of fused multiply-adds on LANES numbers, which fit into registers."""
    values = np.ones(LANES)
    return 2 * LANES * ROUNDS / _least(lambda: _multiply_adds(values, ROUNDS))


def peak_bytes(size: float) -> float:
    """Bytes per second of the addition of two arrays, where the three arrays together have `size` bytes."""
    count = max(64, int(size / 24))
    out, first, second = np.ones((3, count))
    rounds = max(1, 10_000_000 // count)
    return 24 * count * rounds / _least(lambda: _additions(out, first, second, rounds))


def _least(run: Callable[[], Any]) -> float:
    def seconds() -> float:
        begin = time.process_time()
        run()
        return time.process_time() - begin

    return least(seconds, TURNS)


def run_seconds(mechanism: Mechanism, integrator: Any, dt: float, steps: int) -> float:
    """The CPU time [s] of a run of the judge."""
    turns = 4 * TURNS if steps == 1 else TURNS
    return least(lambda: Lagrange(integrator).build(mechanism, dt)(1, steps).stepping, turns)


def measure_roofline() -> Mapping[str, str]:
    """Facts for `SpeedTable.facts`: peaks, work and time of a step of the four-bar and of a chain of 1000 links by the
    difference of two runs, and the time of a run of the four-bar without its steps."""
    facts = {"peak operations": peak_operations()}
    cases = {
        "four-bar": (FreeFourBar().mechanism(), "dop853", 1e-3),
        "chain": (LongPendulum(links=1000).mechanism(), "rk4", 1e-4),
    }
    for name, (mechanism, integrator, dt) in cases.items():
        model = CompiledModel.of(mechanism)
        assert model is not None  # these mechanisms have pins alone
        work, moved = step_work(model, integrator)
        arrays = [value for value in (*model.system, *model.storage) if isinstance(value, np.ndarray)]
        size = sum(array.nbytes for array in arrays)
        facts |= {f"{name} operations": work, f"{name} bytes": moved, f"{name} size": size}
        short, long = (run_seconds(mechanism, integrator, dt, steps) for steps in (STEPS, 2 * STEPS))
        facts |= {f"{name} peak bytes": peak_bytes(size), f"{name} seconds": (long - short) / STEPS}
    facts["judge start"] = run_seconds(*cases["four-bar"], 1) - facts["four-bar seconds"]
    return {name: f"{value:.4g}" for name, value in facts.items()}
