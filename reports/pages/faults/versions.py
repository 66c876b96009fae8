"""What the scripts find with released versions: read from a file, which this module writes when it is run.

python -m reports.pages.faults.versions    # installs each version in the user's cache, runs every script, writes
"""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from reports.pages.faults.scripts import said_apart
from reports.run.installed import environment, installed

RECORDED = Path(__file__).parent / "versions.csv"
FIELDS = ("script", "package", "version", "expected", "found")
MUJOCO = ("mujoco_loop", "mujoco_sparse", "mujoco_joint_equality", "mujoco_tendon_equality")
PYMUNK = ("pymunk_groove", "pymunk_groove_moving", "pymunk_kinetic_energy")
# (distribution, version, scripts): the ends of what is offered, and both sides of every change.
RELEASES = (
    *(("mujoco", version, MUJOCO) for version in ("3.0.0", "3.6.0", "3.7.0", "3.17.0")),
    *(("mujoco-core", version, MUJOCO) for version in ("4.0.0", "4.0.1")),
    *(("pymunk", version, PYMUNK) for version in ("6.4.0", "7.0.0", "7.3.1")),
)


@dataclass(frozen=True)
class Found:
    """What one script expects and finds with one version."""

    script: str
    package: str
    version: str
    expected: float
    found: float

    @property
    def right(self) -> bool:
        """Within what MuJoCo's softness costs at the stiffest setting, 1e-4."""
        return abs(self.found - self.expected) <= 2e-4 * max(1.0, abs(self.expected))


def recorded() -> tuple[Found, ...]:
    """What the file says."""
    with RECORDED.open(encoding="utf-8", newline="") as file:
        return tuple(
            Found(row["script"], row["package"], row["version"], float(row["expected"]), float(row["found"]))
            for row in csv.DictReader(file)
        )


def found_with(package: str, version: str, scripts: Iterable[str]) -> list[Found]:
    """Each script in a process of its own that imports this version.

    Raises BadInput if the version can't be installed, SystemExit if a script fails.
    """
    folder = installed((package,), version)
    own = environment(folder)
    out = []
    for name in scripts:
        try:
            expected, found = said_apart(name, own, folder)
        except RuntimeError as reason:
            raise SystemExit(f"{name} with {package} {version}: {reason}") from None
        out.append(Found(name, package, version, expected, found))
    return out


def main() -> None:
    """Write the file anew; nothing is written unless every version could be run."""
    rows = [found for release in RELEASES for found in found_with(*release)]
    with RECORDED.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FIELDS)
        writer.writerows((row.script, row.package, row.version, repr(row.expected), repr(row.found)) for row in rows)


if __name__ == "__main__":
    main()
