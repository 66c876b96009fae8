"""Checks of MuJoCo's accelerations in the installed release, or in another release by a separate process.

As a program, the module reads models as lines of JSON. The output has a line of JSON with the answer or the exception
for each model.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import json
import subprocess
import sys
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reports.model.fingerprint import ROOT
from reports.run.installed import environment, installed
from reports.search.law import Fault
from reports.search.mujoco_alone import RawModel, StartEquations, start_equations, to_mjcf
from reports.search.parts import case_from_json, case_to_json

DISTRIBUTIONS = ("mujoco-core", "mujoco")  # Mujoco-core exists from version 4.0 on.
# MuJoCo omits the velocity term of curved equalities. The check CURVED expects this term, and the check BESIDE_CURVED
# accepts its absence.
CURVED, BESIDE_CURVED = "acceleration, a known fault", "beside the known fault"


def check_accelerations(model: RawModel, version: str = "") -> dict[str, Any]:
    """The values are relative "errors" by check, the accelerations "found" and "expected", and the "version".
    BESIDE_CURVED is the smaller of the errors with and without the velocity term of curved equalities. `version`: a
    release such as "3.6.0", or "" for the installed release. Raises Fault if the other release raises an exception or
    crashes."""
    if version:
        return _check_in_other_release(version, case_to_json(model))
    import mujoco

    law = start_equations(model)
    give, accelerations = _give_and_found(model, law)

    def error(expected: NDArray[np.float64]) -> float:
        # Scales of accelerations are gravity and the square of the rates.
        size = max(np.abs(expected).max(), np.hypot(*model.gravity), np.abs(law.rates).max() ** 2)
        largest = float(np.abs(accelerations - expected).max())
        if not np.isfinite(largest):
            return np.inf
        return largest / size if size > 0 else (np.inf if largest > 0 else 0.0)

    expected, without = law.expected(give), law.expected(give, bent=False)
    curved = any(curve.any() for curve in law.bent)
    missed = error(expected)
    errors = {CURVED: missed, BESIDE_CURVED: min(missed, error(without))} if curved else {"acceleration": missed}
    return {
        "errors": errors,
        "found": accelerations.tolist(),
        "expected": expected.tolist(),
        "version": mujoco.__version__,
    }


def _give_and_found(model: RawModel, law: StartEquations) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The compliance (rows, rows) from MuJoCo's efc_R, and MuJoCo's accelerations (coordinates,)."""
    import mujoco

    from engines.mujoco.declared import jacobian

    compiled = mujoco.MjModel.from_xml_string(to_mjcf(model))
    data = mujoco.MjData(compiled)
    data.qvel[:] = law.rates
    mujoco.mj_forward(compiled, data)
    count = sum(len(right) for right in law.right)
    give, begin = np.zeros((count, count)), 0
    lines = jacobian(compiled, data)
    for number, rows in enumerate(law.rows):
        mine = [row for row in range(data.nefc) if data.efc_id[row] == number and np.linalg.norm(lines[row]) > 1e-12]
        factors = np.linalg.lstsq(rows.T, lines[mine].T, rcond=None)[0].T
        block = slice(begin, begin + len(rows))
        begin = block.stop
        give[block, block] = np.linalg.solve(factors, np.diag(np.sqrt(data.efc_R[mine])))
    return give, data.qacc.copy()


@cache
def process_of(version: str) -> subprocess.Popen[str]:
    """The process of a release; it is started once. Raises BadInput if the release can't be installed."""
    return subprocess.Popen(
        [sys.executable, "-m", "reports.search.release"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        cwd=ROOT,
        env=environment(installed(DISTRIBUTIONS, version), (ROOT,)),
    )


def _check_in_other_release(version: str, model: str) -> dict[str, Any]:
    process = process_of(version)
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(f"{model}\n")
        process.stdin.flush()
        line = process.stdout.readline()
    except BrokenPipeError:
        line = ""
    if not line:
        process_of.cache_clear()
        raise Fault(f"the process of this release ended with {process.wait()}")
    result = json.loads(line)
    if "raised" in result:
        raise Fault(result["raised"])
    return result


def release_of(name: str) -> str | None:
    """The release in a subject's name, which is "" for the installed release. The result is None if the subject is not
    MuJoCo alone."""
    name_parts = name.split()
    return " ".join(name_parts[2:]) if name_parts[:2] == ["mujoco", "alone"] else None


def main() -> None:
    for line in sys.stdin:
        try:
            result = check_accelerations(case_from_json(line, RawModel))
        except Exception as error:
            result = {"raised": f"{type(error).__name__}: {error}"}
        print(json.dumps(result), flush=True)


if __name__ == "__main__":
    main()
