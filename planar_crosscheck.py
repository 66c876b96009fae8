"""The functions for notebooks and scripts, and the start of the program.

    import planar_crosscheck as crosscheck
    from engines.importers import mujoco

    found = crosscheck.check("model.xml", tolerance=1e-4)   # a model of your own: how wrong, why, what to set
    mechanism = mujoco.read("model.xml")                    # or engines.importers.pymunk.read(space)
    points = {"A": (0, 0), "B": (0, 0.3), "C": (0.8, 0.6), "D": (0.7, 0)}
    mechanism = crosscheck.linkage(points, {"crank": "AB", "coupler": "BC", "rocker": "DC"}, ground="AD")
    crosscheck.draw(mechanism)
    beside = crosscheck.compare(mechanism, "mujoco default", dt=2e-3, duration=1.0)
    beside                                                  # truth, run, errors and a figure; beside.frame() for pandas
    rows = crosscheck.run("free_four_bar", "pymunk", every=[100])   # rows of errors; crosscheck.report() writes pages

Another package may be named `reference`, `engines` or `reports` and hide a package of this suite. `clash` reports this.
Modules that are slow to import are imported inside functions.
"""

from __future__ import annotations

import os
import sys

if __name__ == "__main__" and not sys.flags.safe_path:
    sys.path[0] = os.path.dirname(os.path.realpath(__file__))  # replaces the current folder

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from engines import Engine
    from reference.mechanism import Mechanism
    from reports.check.comparing import Comparison, Picture
    from reports.check.request import CheckReport
    from reports.model.measure import Measurement
    from reports.search.chunk import CaseResult
    from reports.versions.builds import BuildComparison
    from reports.versions.column import VersionColumn

PACKAGES = ("reference", "engines", "reports")
HERE = os.path.dirname(os.path.realpath(__file__))


def clash(packages: tuple[str, ...] = PACKAGES) -> str:
    """An error message if a package is missing or another package hides it, else empty. Imports no package."""
    for name in packages:
        try:
            spec = find_spec(name)
        except (ImportError, ValueError):  # A module of this name has no spec.
            spec = None
        folders = [] if spec is None else list(spec.submodule_search_locations or [spec.origin])
        if os.path.join(HERE, name) not in map(os.path.realpath, filter(None, folders)):
            where = f"is another one, at {folders[0]}" if folders else "is missing"
            return (
                f"the package {name!r} {where}, and ours is at {os.path.join(HERE, name)}: start from another folder, "
                "or in an environment of its own"
            )
    return ""


def check(
    model: Any,
    tolerance: float | None = None,
    duration: float = 2.0,
    *,
    without: Sequence[str] = (),
    key: str = "",
    step: float | None = None,
    quick: bool = False,
    fix_to: float | None = None,
    apply: str | Path = "",
    folder: Path | None = None,
) -> CheckReport:
    """Check a model and return the report. The model is a path, a mujoco.MjModel or a pymunk.Space.

    duration: duration of the motion [s]. tolerance: largest allowed error of angles [rad], and of positions divided by
    the length of the mechanism. Further arguments are options of `crosscheck check`. Relative paths start at `folder`,
    by default the current folder. Raises ValueError if the model can't be checked.
    """
    from reports.check.request import CheckRequest, Refused, run_check

    model_name = str(model) if isinstance(model, str | Path) else type(model).__name__
    wanted = tolerance if fix_to is None else fix_to
    options = {"quick": quick, "search": fix_to is not None, "apply": str(apply), "pictures": True}
    request = CheckRequest(
        model_name, str(folder or Path.cwd()), duration, wanted, tuple(without), key, step, **options
    )
    answer = run_check(request.refuse_bad(), None if isinstance(model, str | Path) else model)
    if isinstance(answer, Refused) or answer.trouble:
        raise ValueError(answer.sentence if isinstance(answer, Refused) else answer.trouble)
    return answer


def compare(mechanism: Mechanism, engine: Engine | str, dt: float, duration: float = 2.0) -> Comparison:
    """Compare the run of an engine at a step dt [s] over a duration [s] with the ideal motion of the mechanism.

    engine: an engine, or a name such as "mujoco tuned". Raises ValueError if the engine can't build the mechanism.
    """
    from reports.check.comparing import compare_with_ideal

    return compare_with_ideal(mechanism, engine, dt, duration)


def run(
    scenes: str | Sequence[str] = (),
    engine: str | None = None,
    variant: str | None = None,
    *,
    settings: Mapping[str, float] | None = None,
    full: bool = False,
    every: Sequence[int] = (),
    steps: Sequence[float] = (),
    fresh: bool = False,
    workers: int | None = None,
    results: str | Path = "crosscheck-results",
) -> list[Measurement]:
    """Return the rows of `crosscheck run`. Cells that are not stored in the folder `results` are run and stored there.

    scenes: names of scenes or pages; if empty, all scenes. settings: changed parameters of the scenes. every: numbers
    of steps between two samples. steps: step sizes [s]. Raises ValueError.
    """
    from reports.cli.run import run_grid, select

    names = (scenes,) if isinstance(scenes, str) else tuple(scenes)
    numbers = tuple(f"{name}={value!r}" for name, value in (settings or {}).items())
    chosen = select(names, engine, variant, numbers, full, every, steps)
    return run_grid(chosen, Path(results), workers, fresh)


def report(results: str | Path = "crosscheck-results") -> Path:
    """Write pages, charts and tables of the stored results; return the first page's path. Raises ValueError."""
    from reports.cli.report import write_report

    return write_report(Path(results))[0] / "index.md"


def search(
    engine: str | None = None,
    variant: str | None = None,
    *,
    cases: int = 200,
    seed: int | None = None,
    seconds: float | None = None,
    workers: int | None = None,
    results: str | Path = "crosscheck-results",
) -> list[CaseResult]:
    """Check random mechanisms like `crosscheck search`, in the variants of one engine or of all engines.

    The default seed follows from the last commit. No case starts after `seconds`. The cases and the reduced
    findings are stored in the folder `results`. Raises ValueError.
    """
    from reports.cli.options import SEARCH
    from reports.cli.search import chosen_subjects
    from reports.search.run import run_search

    subjects = chosen_subjects(engine, variant)
    return run_search(Path(results) / SEARCH, subjects, cases, seed, seconds=seconds, workers=workers)[0]


def versions(
    engine: str, version: str, scenes: Sequence[str] = (), results: str | Path = "crosscheck-results"
) -> VersionColumn:
    """Run scenes in a release of an engine, by default six short scenes. pip installs the release once.

    Raises ValueError if the release does not exist.
    """
    from reports.cli.options import STORE
    from reports.versions.builds import run_release, scenes_named

    return run_release(engine, version, scenes_named(scenes) if scenes else None, Path(results) / STORE)


def build_comparison(
    first: str,
    second: str,
    engine: str | None = None,
    variants: Sequence[str] = (),
    scenes: Sequence[str] = (),
    results: str | Path = "crosscheck-results",
) -> BuildComparison:
    """Compare two builds of an engine. A build is NAME==VERSION, the path of a wheel, or a folder.

    `complaint` of the result is empty unless the second build is worse. Raises ValueError.
    """
    from reports.versions.builds import compare_builds, scenes_named

    chosen = scenes_named(scenes) if scenes else None
    return compare_builds(first, second, engine, variants, chosen, Path(results))


def linkage(
    points: Mapping[str, tuple[float, float]],
    bars: Mapping[str, Sequence[str]],
    ground: Sequence[str],
    gravity: tuple[float, float] = (0.0, -9.81),
    density: float = 1.0,
) -> Mechanism:
    """A mechanism at rest that consists of uniform bars between named points [m]. Pins connect bars at common points.

    bars: name -> two points. ground: the points that are pinned to the ground. gravity: [m/s^2]. density: [kg/m].
    Raises ValueError.
    """
    from reference.linkage import linkage as made

    return made(points, bars, ground, gravity, density)


def draw(mechanism: Mechanism, pose: Any = None) -> Picture:
    """A picture of a mechanism in a pose (bodies, 3) [m, m, rad], by default the initial pose."""
    from reports.check.comparing import draw_mechanism

    return draw_mechanism(mechanism, pose)


def conform(engine: Engine, expected_failures: Mapping[str, str] | None = None) -> Any:
    """Check an engine against the rules for all engines; see `engines.conformance.conform`. Raises AssertionError."""
    from engines.conformance import conform as asked

    return asked(engine, expected_failures)


def main() -> None:
    """The program `crosscheck`. Always raises SystemExit."""
    message = clash()
    if message:
        print(f"crosscheck: {message}", file=sys.stderr)
        sys.exit(2)
    from reports.__main__ import main as program

    program()


if __name__ == "__main__":
    main()
