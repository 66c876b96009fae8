"""Claims of pages ("falls", "stays", "torn") as predicates on rows and motions: without them nothing is published.

Those of an experiment stand below its text in `experiments.md`, as Jinja expressions with the names of `_names` and the
words of the experiment. Those of other parts of pages are functions here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Any

from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.pages.atlas.page import lines as atlas_lines
from reports.pages.guides import page as guides
from reports.write.rows import Rows
from reports.write.templates import environment
from reports.write.unmeasured import UNMEASURED


def _names(failure: Failure, material: Material) -> dict[str, Any]:
    """The functions of an experiment's claims. Rows of a method are sorted by step, the largest first."""
    whole = Rows(sorted(material.of(failure.cells), key=lambda row: -row.step))

    def rows(method: str) -> Rows:
        if found := whole.of(method=method, purpose=""):
            return found
        raise LookupError(f"there are no rows of {method!r}")

    def errors(methods: tuple[str, ...], name: str) -> list[float]:
        return [getattr(row, name) for method in methods for row in rows(method)]

    def falls(method: str, factor: float = 5.0, name: str = "angle") -> bool:
        """Whether each error is less than a part of the one at the next larger step."""
        values = errors((method,), name)
        return len(values) > 1 and all(fine < coarse / factor for coarse, fine in pairwise(values))

    def stays(method: str, skip: int = 0) -> bool:
        """Whether errors at neighbouring steps differ by at most a quarter, but for the first ones."""
        values = errors((method,), "angle")[skip:]
        return len(values) > 1 and all(0.8 < fine / coarse < 1.25 for coarse, fine in pairwise(values))

    def above(method: str, other: str, factor: float = 1.0) -> bool:
        """Whether the first has more than so many times the error of the other, at each step."""
        pairs = zip(errors((method,), "angle"), errors((other,), "angle"), strict=True)
        return all(first > factor * second for first, second in pairs)

    def share(*outcomes: str, without: str = "") -> float:
        """The share of runs that end so, of all methods but one."""
        counted = Rows(row for row in whole if row.method != without)
        return counted.count(*outcomes) / counted.count()

    def alike(scene: str, name: str, *methods: str) -> bool:
        """Whether methods have the same errors here as in the sweep of a scene, within 1 %."""
        sweep = {(row.method, row.every): getattr(row, name) for row in material.rows.values() if _is_of(row, scene)}
        return all(
            abs(getattr(row, name) / sweep[method, row.every] - 1) < 0.01 for method in methods for row in rows(method)
        )

    return {
        "rows": rows,
        "at": lambda method, step: rows(method).near(step),
        "ends": lambda method: [str(row.outcome) for row in rows(method)],
        "comparable": lambda method: [Outcome(row.outcome).comparable for row in rows(method)],
        "unresolved": lambda method: all("unresolved" in f"{row.outcome} {row.sentence}" for row in rows(method)),
        "estimated": lambda method: all(row.estimate > row.angle for row in rows(method)),
        "silent": lambda: all("without a warning" in row.sentence for row in whole),
        "smallest": lambda name, *methods: min(errors(methods, name)),
        "largest": lambda name, *methods: max(errors(methods, name)),
        "falls": falls,
        "stays": stays,
        "ratio": lambda method: rows(method)[-1].angle / rows(method)[-2].angle,  # smallest step over the next one
        "above": above,
        "share": share,
        "alike": alike,
        **failure.context(material),
    }


def _is_of(row: Measurement, scene: str) -> bool:
    return (row.scene, row.purpose) == (scene, "sweep")


def settings_of_a_loop(material: Material) -> bool:
    """One change wins little, both win much, and implicitfast does what Euler does."""
    rows = Rows(material.sweep((guides.FOUR_BAR,)))

    def method(name: str) -> Rows:
        return rows.of(guides.FOUR_BAR.name, name)

    def at(name: str, every: int = guides.EVERY) -> Any:
        return next((row for row in method(name) if row.every == every), UNMEASURED)

    euler, implicit, tuned = (f"mujoco {name}" for name in ("stiff Euler", "stiff implicitfast", "tuned"))
    shipped, extended = at("mujoco default").angle, at("pymunk extended")
    return (
        min(at("mujoco RK4 alone").angle, at(euler).angle) > shipped / 2
        and at(tuned).angle < 1e-3 * shipped
        and all(abs(at(implicit, n).angle / at(euler, n).angle - 1) < 0.01 for n in (1, guides.EVERY))
        and all(abs(method(name).sweep().order - n) < 0.1 for name, n in ((euler, 1), (implicit, 1), (tuned, 2)))
        and not method(tuned).sweep().plateau > 0
        and method(tuned).sweep("reaction").plateau > 10 * at(tuned).angle
        and extended.reaction > 100 * extended.angle
    )


def _map(subject: str) -> dict[str, dict[float, tuple[Outcome, ...]]]:
    """Outcomes of a map of the atlas by method and value, largest step first."""
    found: dict[str, dict[float, tuple[Outcome, ...]]] = {}
    for line in atlas_lines():
        if line.subject == subject:
            found.setdefault(line.method, {})[line.value] = line.told
    return found


def maps(material: Material) -> bool:
    """What the atlas says of couplers, of slots near their reach, and of sleighs."""
    couplers, offsets, sleighs = (_map(subject) for subject in ("coupler", "offset", "sleigh"))
    soft, naive = couplers["mujoco default"], sleighs.pop("pymunk default")
    nearest = [offsets[f"{name} default"] for name in ("pymunk", "mujoco")]
    right = [couplers["mujoco tuned"], offsets["pymunk tuned"], *sleighs.values()]
    return (
        all(set(soft[value]) == {Outcome.TORN} for value in (min(soft), max(soft)))
        and all(ends[min(ends)][-1] is Outcome.BRANCH_FLIP for ends in nearest)
        and naive[min(naive)][-1].comparable
        and not naive[max(naive)][-1].comparable
        and all(outcomes[-1].comparable for ends in right for outcomes in ends.values())
    )


# By page.
OTHERS: Mapping[str, Callable[[Material], bool]] = {
    "atlas": maps,
    "settings": settings_of_a_loop,
}


def contradicted(pages: Mapping[Page, Material]) -> list[str]:
    """The claims that the rows or motions of these pages contradict or do not have, as "page, experiment: claim"."""
    return [where for page, material in pages.items() for where, claim in _claims(page, material) if not _holds(claim)]


def _claims(page: Page, material: Material) -> Iterator[tuple[str, Callable[[], Any]]]:
    if page.name in OTHERS:
        yield f"{page.name}: {OTHERS[page.name].__name__}", lambda: OTHERS[page.name](material)
    for failure in page.failures:
        names = _names(failure, material) if failure.claims else {}
        for claim in failure.claims:
            expression = environment().compile_expression(claim, undefined_to_none=False)
            yield f"{page.name}, {failure.title}: {claim}", lambda e=expression, n=names: e(n)


def _holds(claim: Callable[[], Any]) -> bool:
    try:
        return bool(claim())
    except (LookupError, StopIteration, ValueError):  # a method or a step of the claim was not run
        return False
