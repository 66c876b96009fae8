"""The scripts that show the faults, run as they are printed; and what they find with released versions.

python -m reports.pages.faults.scripts    # installs each version in the user's cache, runs every script, writes
"""

from __future__ import annotations

import contextlib
import csv
import hashlib
import io
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from engines import Engine, Unsupported
from engines.mjx import DEFAULT
from reports.model.tasks import Task, Values
from reports.run.installed import environment, installed, numbers
from reports.versions import catalogue

FOLDER = Path(__file__).parent / "snippets"
# Printed by a process of its own behind a script's last line.
TOLD = '\nprint("told", repr(float(expected)), repr(float(found)))\n'
MJX = ("mjx_loop",)


@cache
def source(name: str) -> str:
    """The script's text. Raises FileNotFoundError for a name that is none."""
    return (FOLDER / f"{name}.py").read_text(encoding="utf-8")


def said(name: str) -> tuple[float, float]:
    """What the script expects and what it finds, run in this process, with the engine that is installed."""
    space: dict[str, float] = {"__name__": "__main__"}  # type: ignore[dict-item]
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(source(name), f"{name}.py", "exec"), space)
    return float(space["expected"]), float(space["found"])


def said_apart(name: str, own: Mapping[str, str] | None = None, folder: Path | None = None) -> tuple[float, float]:
    """The same by a process with this environment in this folder. Raises RuntimeError if the script fails there."""
    command = [sys.executable, "-c", source(name) + TOLD]
    run = subprocess.run(command, capture_output=True, text=True, env=own, cwd=folder, check=False)
    words = run.stdout.split()[-3:]
    if run.returncode or words[:1] != ["told"]:
        raise RuntimeError((run.stderr or run.stdout).strip().splitlines()[-1])
    return float(words[1]), float(words[2])


@dataclass(frozen=True)
class Script(Task):
    """One script; `digest` is that of its text, so that an answer to another text is stale."""

    name: str
    digest: str

    @property
    def cost(self) -> float:
        return 6.0 if self.name in MJX else 0.05  # measured: compiling a program, and a model

    @property
    def label(self) -> str:
        return f"script {self.name}"

    @property
    def engine(self) -> Engine | None:
        return DEFAULT if self.name in MJX else None

    def run(self) -> Values:
        """`expected` and `found`, in the unit that the script says, and `version` of the engine's package.

        Raises Unsupported where the script's package is an extra that is not installed.
        """
        if self.name in MJX:
            return self._apart()
        import mujoco

        expected, found = said(self.name)
        # pymunk.version is wrong in some releases (2.0.0 in 7.0.0), and MuJoCo's distribution has two names.
        release = mujoco.__version__ if self.name.startswith("mujoco") else version("pymunk")
        return {"expected": np.asarray(expected), "found": np.asarray(found), "version": release}

    def _apart(self) -> Values:
        """JAX takes its settings from whoever imports it first, so it is not imported here."""
        DEFAULT.require()
        try:
            expected, found = said_apart(self.name)
        except RuntimeError as reason:
            raise Unsupported(f"MJX does not run here: {reason}") from None
        return {"expected": np.asarray(expected), "found": np.asarray(found), "version": version("mujoco-mjx")}


def script(name: str) -> Script:
    """The task of a script as it stands now."""
    return Script(name, hashlib.sha256(source(name).encode()).hexdigest()[:16])


RECORDED = Path(__file__).parent / "versions.csv"
FIELDS = ("script", "package", "version", "expected", "found")
MUJOCO = (
    *("mujoco_loop", "mujoco_sparse", "mujoco_joint_equality", "mujoco_tendon_equality"),
    "mujoco_site_near_origin",
)
PYMUNK = ("pymunk_groove", "pymunk_groove_moving", "pymunk_kinetic_energy")


def _telling(engine: str) -> list[str]:
    """Of the versions of an engine that are compared the first and the last, and both sides of every known change."""
    own = [each for each in catalogue.RELEASES if each.engine == engine]
    changes = [index for index, each in enumerate(own) if each.changed]
    chosen = {0, len(own) - 1, *changes, *(index - 1 for index in changes)}
    return [own[index].version for index in sorted(chosen)]


# (distribution, version, scripts). MuJoCo's distribution of this name is a bundle from its fourth version on.
BUNDLED = numbers("4")
ASKED = (
    *(("mujoco-core" if numbers(each) >= BUNDLED else "mujoco", each, MUJOCO) for each in _telling("mujoco")),
    *(("pymunk", each, PYMUNK) for each in _telling("pymunk")),
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
    rows = [found for release in ASKED for found in found_with(*release)]
    with RECORDED.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FIELDS)
        writer.writerows((row.script, row.package, row.version, repr(row.expected), repr(row.found)) for row in rows)


if __name__ == "__main__":
    main()
