"""Where a method is known to fall short on the person, each with its reason."""

from __future__ import annotations

KNOWN: dict[tuple[str, str, str], str] = {
    ("person_two_feet", "mujoco default", "reaction"): (
        "by design: as shipped a loop's compliance yields a twentieth of its force, and the reactions with it"
    ),
}
