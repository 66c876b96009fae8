"""The scripts that show the faults, run as they are printed; and what they print with released and mended versions.

python -m reports.pages.faults.scripts    # installs each version in the user's cache, runs every script, writes

pymunk is also built from its source package with our patches, and its own tests are run with that build.
"""

from __future__ import annotations

import contextlib
import csv
import io
import platform
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from engines import Engine, Unsupported
from engines.mjx import DEFAULT
from reports.model.digest import digest
from reports.model.ending import BadInput
from reports.model.tasks import Task, Values
from reports.run.files import temporary_folder
from reports.run.installed import built, environment, installed, numbers, sources
from reports.versions import catalogue

FOLDER = Path(__file__).parent / "snippets"
ROOT = Path(__file__).parents[3]
LINE = re.compile(r"expected (\S+), found (\S+)$")  # how a script ends that shows a fault
UNASKED = "Failed to import"  # what MJX prints of Warp, which is not asked for
OWN_TESTS = "pymunk.tests"  # pymunk's own, `python -m pymunk.tests`
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


def printed(name: str, own: Mapping[str, str] | None = None, folder: Path | None = None) -> str:
    """What a script prints in a process with this environment in this folder. Raises RuntimeError if it fails there."""
    run = subprocess.run([sys.executable, "-c", source(name)], capture_output=True, text=True, env=own, cwd=folder)
    if run.returncode:
        raise RuntimeError((run.stderr or run.stdout).strip().splitlines()[-1])
    return "\n".join(line for line in run.stdout.splitlines() if not line.startswith(UNASKED))


def outcome(text: str) -> tuple[float, float]:
    """What a script expects and finds, by what it printed. Raises ValueError for another text."""
    match = LINE.search(text)
    if match is None:
        raise ValueError(f"{text!r} does not end in 'expected ..., found ...'")
    return float(match[1]), float(match[2])


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
            expected, found = outcome(printed(self.name))
        except RuntimeError as reason:
            raise Unsupported(f"MJX does not run here: {reason}") from None
        return {"expected": np.asarray(expected), "found": np.asarray(found), "version": version("mujoco-mjx")}


def script(name: str) -> Script:
    """The task of a script as it stands now."""
    return Script(name, digest(source(name)))


RECORDED = Path(__file__).parent / "recorded.csv"
FIELDS = ("script", "package", "version", "machine", "printed")
MUJOCO = (
    *("mujoco_loop", "mujoco_sparse", "mujoco_joint_equality", "mujoco_tendon_equality"),
    "mujoco_site_near_origin",
)
PYMUNK = ("pymunk_groove", "pymunk_groove_moving", "pymunk_kinetic_energy")
# What the faults cost over time, and what mends them.
PYMUNK_COSTS = ("pymunk_groove_cost", "pymunk_kinetic_energy_cost", "pymunk_groove_random", OWN_TESTS)
MUJOCO_COSTS = (
    *("mujoco_joint_equality_cost", "mujoco_tendon_equality_cost", "mujoco_loop_cost", "mujoco_sparse_cost"),
    *("mujoco_joint_equality_mended", "mujoco_tendon_equality_mended"),
)
PATCHES = ("pymunk_groove.patch", "pymunk_kinetic_energy.patch")
PATCHED = " with both patches"  # behind the version of the release


def _telling(engine: str) -> list[str]:
    """Of the versions of an engine that are compared the first and the last, and both sides of every known change."""
    own = [each for each in catalogue.RELEASES if each.engine == engine]
    changes = [index for index, each in enumerate(own) if each.changed]
    chosen = {0, len(own) - 1, *changes, *(index - 1 for index in changes)}
    return [own[index].version for index in sorted(chosen)]


def _further(engine: str, version: str) -> tuple[str, ...]:
    """The scripts beside those of every version: all costs with the newest, one with the version that has its fault."""
    if version == _telling(engine)[-1]:
        return PYMUNK_COSTS if engine == "pymunk" else MUJOCO_COSTS
    return {"3.6.0": ("mujoco_loop_cost",), "4.0.0": ("mujoco_sparse_cost",)}.get(version, ())


# (distribution, version, scripts). MuJoCo's distribution of this name is a bundle from its fourth version on.
BUNDLED = numbers("4")
MATCHED = "3.17.0"  # of MJX and of MuJoCo's C code, the newest that both have
ASKED = (
    *(
        ("mujoco-core" if numbers(each) >= BUNDLED else "mujoco", each, MUJOCO + _further("mujoco", each))
        for each in _telling("mujoco")
    ),
    *(("pymunk", each, PYMUNK + _further("pymunk", each)) for each in _telling("pymunk")),
    ("pymunk", _telling("pymunk")[-1] + PATCHED, PYMUNK + PYMUNK_COSTS),
    ("mujoco-mjx", MATCHED, ("mjx_loop", "mjx_loop_cost")),
)


@dataclass(frozen=True)
class Found:
    """What one script prints with one version; `machine`: Python and platform."""

    script: str
    package: str
    version: str
    machine: str
    printed: str

    @property
    def expected(self) -> float:
        return outcome(self.printed)[0]

    @property
    def found(self) -> float:
        return outcome(self.printed)[1]

    @property
    def right(self) -> bool:
        """Within what MuJoCo's softness costs at the stiffest setting, 1e-4."""
        return abs(self.found - self.expected) <= 2e-4 * max(1.0, abs(self.expected))


def recorded() -> tuple[Found, ...]:
    """What the file says."""
    with RECORDED.open(encoding="utf-8", newline="") as file:
        return tuple(Found(**row) for row in csv.DictReader(file))


def patched(release: str) -> Path:
    """The folder with pymunk built from its source package with our patches. Raises BadInput, in one line."""
    with temporary_folder() as folder:
        tree = sources("pymunk", release, folder)
        for path in (tree / "Munk2D").rglob("*.[ch]"):  # some have another end of line than the patches
            path.write_bytes(path.read_bytes().replace(b"\r\n", b"\n"))
        for name in PATCHES:
            ended = subprocess.run(["patch", "-p1", "-i", str(FOLDER / name)], cwd=tree, capture_output=True, text=True)
            if ended.returncode:
                raise BadInput(f"{name} does not fit pymunk {release}: {ended.stdout.strip()}")
        return built(tree)


def own_tests(own: Mapping[str, str], folder: Path) -> str:
    """How pymunk's own tests end: how many were run, and the names of those that fail."""
    command = [sys.executable, "-m", OWN_TESTS]
    run = subprocess.run(command, capture_output=True, text=True, env=own, cwd=folder)
    lines = (run.stdout + run.stderr).splitlines()
    count = [line.partition(" in ")[0] for line in lines if line.startswith("Ran ")]
    failing = [line.partition(" (")[0] for line in lines if line.startswith(("FAIL:", "ERROR:"))]
    ending = [line for line in lines if line.startswith(("OK", "FAILED"))]
    return "\n".join([*failing, *count, *ending])


def found_with(package: str, release: str, scripts: Iterable[str]) -> list[Found]:
    """Each script in a process of its own that imports this version.

    Raises BadInput if the version can't be installed or built, SystemExit if a script fails.
    """
    further: Sequence[Path] = ()
    if release.endswith(PATCHED):
        folder = patched(release.removesuffix(PATCHED))
    else:
        folder = installed((package,), release)
        further = (installed(("mujoco",), release),) if package == "mujoco-mjx" else ()
    own = environment(folder, (*further, ROOT))  # ours for the random grooves alone
    machine = f"Python {platform.python_version()}, {platform.system()} {platform.machine()}"
    out = []
    for name in scripts:
        try:
            text = own_tests(own, folder) if name == OWN_TESTS else printed(name, own, folder)
        except RuntimeError as reason:
            raise SystemExit(f"{name} with {package} {release}: {reason}") from None
        out.append(Found(name, package, release, machine, text))
    return out


def main() -> None:
    """Write the file anew; nothing is written unless every version could be run."""
    rows = [found for release in ASKED for found in found_with(*release)]
    with RECORDED.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(FIELDS)
        writer.writerows([getattr(row, name) for name in FIELDS] for row in rows)


if __name__ == "__main__":
    main()
