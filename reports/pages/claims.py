"""Claims of pages as predicates on rows and motions. A report is not published if a claim is false.

The claims of an experiment are Jinja expressions in `experiments.md`, which can use the functions of `_names` and the
experiment's context. Claims that belong to no experiment are functions in this module.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Any

from engines.contract import CLAIM
from reports.model.outcomes import SILENT, Outcome
from reports.model.page import Failure, Material, Page
from reports.pages.atlas.page import stored_columns
from reports.pages.guides import page as guides
from reports.write.rows import Rows
from reports.write.templates import environment
from reports.write.unmeasured import UNMEASURED


def _names(failure: Failure, material: Material) -> dict[str, Any]:
    """The functions that claims can use. The rows of a method are sorted by step; the largest step is first."""
    experiment = Rows(sorted(material.of(failure.cells), key=lambda row: -row.step))

    def rows(method: str) -> Rows:
        if of_method := experiment.of(method=method, purpose=""):
            return of_method
        raise LookupError(f"there are no rows of {method!r}")

    def errors(methods: tuple[str, ...], name: str) -> list[float]:
        return [getattr(row, name) for method in methods for row in rows(method)]

    def falls(method: str, factor: float = 5.0, name: str = "angle") -> bool:
        """Whether each error is less than 1 / `factor` of the error at the next larger step."""
        values = errors((method,), name)
        return len(values) > 1 and all(fine < coarse / factor for coarse, fine in pairwise(values))

    def stays(method: str, skip: int = 0) -> bool:
        """Whether neighbouring errors differ by less than a quarter; the first `skip` errors are ignored."""
        values = errors((method,), "angle")[skip:]
        return len(values) > 1 and all(0.8 < fine / coarse < 1.25 for coarse, fine in pairwise(values))

    def above(method: str, other: str, factor: float = 1.0) -> bool:
        """Whether at each step the error of `method` is more than `factor` times the error of `other`."""
        pairs = zip(errors((method,), "angle"), errors((other,), "angle"), strict=True)
        return all(first > factor * second for first, second in pairs)

    def share(*outcomes: str, without: str = "") -> float:
        """The share of runs that have one of `outcomes`; runs of the method `without` are not counted."""
        counted = Rows(row for row in experiment if row.method != without)
        return counted.count(*outcomes) / counted.count()

    def same_as_in(scene: str, name: str, *methods: str) -> bool:
        """Whether the errors of `methods` equal their errors in the sweep of `scene` within 1 %."""
        sweep = {
            (row.method, row.every): getattr(row, name)
            for row in material.rows.values()
            if (row.scene, row.purpose) == (scene, "sweep")
        }
        return all(
            abs(getattr(row, name) / sweep[method, row.every] - 1) < 0.01 for method in methods for row in rows(method)
        )

    return {
        "rows": rows,
        "at": lambda method, step: rows(method).near(step),
        "ends": lambda method: [str(row.outcome) for row in rows(method)],
        "comparable": lambda method: [Outcome(row.outcome).comparable for row in rows(method)],
        "unresolved": lambda method: all(
            row.outcome == Outcome.UNRESOLVED or row.estimate > CLAIM for row in rows(method)
        ),
        "estimated": lambda method: all(row.estimate > row.angle for row in rows(method)),
        "silent": lambda: all(SILENT in row.sentence for row in experiment),
        "smallest": lambda name, *methods: min(errors(methods, name)),
        "largest": lambda name, *methods: max(errors(methods, name)),
        "falls": falls,
        "stays": stays,
        # ratio of the errors at the two smallest steps
        "ratio": lambda method: rows(method)[-1].angle / rows(method)[-2].angle,
        "above": above,
        "share": share,
        "alike": same_as_in,
        **failure.context(material),
    }


def settings_of_a_loop(material: Material) -> bool:
    """Whether the statements of the page "settings" on MuJoCo hold. A stiff loop alone or RK4 alone reduces the error
    by a factor below 2. A stiff loop with RK4 reduces the error by a factor above 1000. The integrator implicitfast has
    the errors of Euler."""
    rows = Rows(material.sweep((guides.SETTINGS_LOOP,)))

    def method(name: str) -> Rows:
        return rows.of(guides.SETTINGS_LOOP.name, name)

    def at(name: str, every: int = guides.MILLISECONDS_PER_SAMPLE) -> Any:
        return next((row for row in method(name) if row.every == every), UNMEASURED)

    euler, implicit, tuned = (f"mujoco {name}" for name in ("stiff Euler", "stiff implicitfast", "tuned"))
    shipped, extended = at("mujoco default").angle, at("pymunk extended")
    return (
        min(at("mujoco RK4 alone").angle, at(euler).angle) > shipped / 2
        and at(tuned).angle < 1e-3 * shipped
        and all(abs(at(implicit, n).angle / at(euler, n).angle - 1) < 0.01 for n in (1, guides.MILLISECONDS_PER_SAMPLE))
        and all(abs(method(name).sweep().order - n) < 0.1 for name, n in ((euler, 1), (implicit, 1), (tuned, 2)))
        and not method(tuned).sweep().plateau > 0
        and method(tuned).sweep("reaction").plateau > 10 * at(tuned).angle
        and extended.reaction > 100 * extended.angle
    )


def _outcomes_of_map(name: str) -> dict[str, dict[float, tuple[Outcome, ...]]]:
    """Method -> parameter value -> outcomes at decreasing steps, in one map of the atlas."""
    outcomes: dict[str, dict[float, tuple[Outcome, ...]]] = {}
    for column in stored_columns():
        if column.subject == name:
            outcomes.setdefault(column.method, {})[column.value] = column.outcome_of_steps
    return outcomes


def maps(material: Material) -> bool:
    """Whether the remarks of the atlas on the maps "coupler", "offset" and "sleigh" hold."""
    couplers, offsets, sleighs = (_outcomes_of_map(name) for name in ("coupler", "offset", "sleigh"))
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


# Page -> claim that belongs to no experiment.
PAGE_CLAIMS: Mapping[str, Callable[[Material], bool]] = {
    "atlas": maps,
    "settings": settings_of_a_loop,
}


def contradicted(pages: Mapping[Page, Material]) -> list[str]:
    """The claims that are false or that lack rows or motions, as texts "page, experiment: claim"."""
    return [where for page, material in pages.items() for where, claim in _claims(page, material) if not _holds(claim)]


def _claims(page: Page, material: Material) -> Iterator[tuple[str, Callable[[], Any]]]:
    if page.name in PAGE_CLAIMS:
        yield f"{page.name}: {PAGE_CLAIMS[page.name].__name__}", lambda: PAGE_CLAIMS[page.name](material)
    for failure in page.failures:
        names = _names(failure, material) if failure.claims else {}
        for claim in failure.claims:
            expression = environment().compile_expression(claim, undefined_to_none=False)
            yield f"{page.name}, {failure.title}: {claim}", lambda e=expression, n=names: e(n)


def _holds(claim: Callable[[], Any]) -> bool:
    try:
        return bool(claim())
    except (LookupError, StopIteration, ValueError):  # a method or step of the claim was not run
        return False
