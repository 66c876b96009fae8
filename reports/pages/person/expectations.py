"""Where a method is known to fall short on the person, each with its reason."""

from __future__ import annotations

from reports.gate.checks import Deviation

ESTIMATED = (
    "ours: the judge takes the inverse inertia of the row itself, MuJoCo an estimate that is larger in this loop"
)

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("person_two_feet", "mujoco tuned", "error"): Deviation(ESTIMATED, 1.2),
    ("person_two_feet", "mujoco tuned", "gap"): Deviation(ESTIMATED, 1.6),
}
