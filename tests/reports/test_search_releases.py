"""The search's own controls: it finds the faults of past releases of MuJoCo, and none where there are none.

Both faults are silent. 3.6.0 leaves the velocity term out of connects and welds; 4.0.0 factorises the Hessian of its
Newton solver wrongly for some trees that branch, where the Jacobian is sparse.
"""

from __future__ import annotations

import time

import pytest

from reports.model.ending import BadInput
from reports.run.installed import installed
from reports.search import raw, raw_law
from reports.search.release import DISTRIBUTIONS, Release
from reports.search.subjects import LAW

KINDS = ("connect", "weld", "gear")
SEED = 1


def first_fault(release: Release, cases: int) -> tuple[int, raw.Model] | None:
    for number in range(cases):
        model = raw_law.model(SEED, number, KINDS)
        told = release.asked(model)
        assert "errors" in told, told
        if not told["errors"]["acceleration"] <= LAW:
            return number, model
    return None


@pytest.mark.slow
@pytest.mark.parametrize(("version", "most"), [("3.6.0", 20), ("4.0.0", 2000)])
def test_the_fault_of_a_past_release_is_found(version: str, most: int) -> None:
    try:
        folder = installed(DISTRIBUTIONS, version)
    except BadInput as reason:
        pytest.skip(f"MuJoCo {version} can't be installed here: {reason}")
    release = Release(folder)
    begin = time.process_time()
    try:
        found = first_fault(release, most)
    finally:
        release.close()
    assert found is not None
    number, model = found
    print(f"{version}: case {number} after {time.process_time() - begin:.1f} s of CPU time here")
    assert raw_law.errors(model)["acceleration"] <= LAW  # the installed release is right there
    assert version != "4.0.0" or model.sparse


@pytest.mark.slow
def test_four_thousand_cases_of_connects_welds_and_hinges_give_nothing() -> None:
    begin = time.process_time()
    worst = max(
        raw_law.errors(raw_law.model(SEED, number, ("connect", "weld")))["acceleration"] for number in range(4000)
    )
    print(f"4,000 cases in {time.process_time() - begin:.0f} s of CPU time, the worst error is {worst:.1e}")
    assert worst <= LAW
