"""Claims of remarks ("falls", "stays", "tears") as predicates on the rows and motions of their experiments.

`crosscheck report --publish` refuses to publish a remark that the rows contradict.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise
from typing import Any

from engines import mujoco, pymunk
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.pages.atlas.page import lines as atlas_lines
from reports.pages.engines import experiments as engines
from reports.pages.guides import page as guides
from reports.pages.pendulum.page import PATIENT, SWEPT
from reports.pages.rolling import experiments as rolling
from reports.pages.skate import experiments as skate
from reports.pages.wheels import page as wheels
from reports.write.rows import Rows
from reports.write.unmeasured import UNMEASURED

Methods = Mapping[str, list[Measurement]]  # the rows of each method, largest step first
BROKEN = (Outcome.TORN, Outcome.RESET)


def falls(rows: list[Measurement], factor: float = 5.0) -> bool:
    return len(rows) > 1 and all(fine.angle < coarse.angle / factor for coarse, fine in pairwise(rows))


def stays(rows: list[Measurement]) -> bool:
    return len(rows) > 1 and all(0.8 < fine.angle / coarse.angle < 1.25 for coarse, fine in pairwise(rows))


def outcomes(rows: list[Measurement]) -> list[Outcome]:
    return [Outcome(row.outcome) for row in rows]


def comparable(rows: list[Measurement]) -> list[bool]:
    return [outcome.comparable for outcome in outcomes(rows)]


def says_unresolved(rows: list[Measurement]) -> bool:
    return all("unresolved" in f"{row.outcome} {row.sentence}" for row in rows)


def change_points(of: Methods) -> bool:
    return (
        falls(of["pymunk default"])
        and falls(of["pymunk tuned"])
        and stays(of["mujoco default"])
        and all(comparable(of["lagrange rk4 projection"]))
        and outcomes(of["pymunk extended"])[0] is Outcome.UNRESOLVED
        and all(outcomes(of[name]).count(Outcome.RESET) == 1 for name in ("mujoco tuned", "mujoco extended"))
    )


def driven_cranks(of: Methods) -> bool:
    overwritten, tuned = of["mujoco tuned, overwritten crank"], of["mujoco tuned"]
    return (
        stays(of["mujoco default, overwritten crank"][1:])
        and stays(of["mujoco tuned, servo"])
        and falls(tuned)
        and outcomes(overwritten)[0] is Outcome.TORN
        and falls(overwritten)
        and all(row.angle > 100 * other.angle for row, other in zip(overwritten, tuned, strict=True))
    )


def large_steps_of_four_bars(of: Methods) -> bool:
    # Where its runs are no series in the step the extrapolation keeps its finest one, which holds together.
    rows = [row for name, rows in of.items() if name != "pymunk extended" for row in rows]
    return says_unresolved(of["pymunk extended"]) and 0.4 < outcomes(rows).count(Outcome.TORN) / len(rows) < 0.6


def cancelled_errors(of: Methods) -> bool:
    lucky, finer = (next(row for row in of["mujoco default"] if 0.5 < row.step / step < 2) for step in (1e-3, 1e-4))
    return lucky.angle < finer.angle / 5


def few_sweeps(of: Methods) -> bool:
    two = of["pymunk tuned, 2 sweeps"]
    return comparable(two)[1:] == [True, False] and outcomes(two)[-1] is Outcome.TORN


def forces_without_limit(of: Methods) -> bool:
    extended, extrapolated = of["mujoco extended"], of["pymunk extended"]
    return (
        comparable(of["pymunk tuned"]) == [True, True, False]
        and falls(of["pymunk default"])
        and falls(of["mujoco tuned"])
        and stays(of["mujoco default"])
        and max(row.angle for row in extended) < 1e-6
        and not falls(extended, 1.0)
        and says_unresolved(extrapolated)
        and all(row.estimate > row.angle for row in extrapolated)
    )


def point_pendulum(of: Methods) -> bool:
    shipped, closed = of["pymunk default"], of["pymunk tuned"]
    euler, fourth = of["mujoco default"], of["mujoco tuned"]
    return (
        min(row.energy for row in shipped) > 0.9
        and closed[-1].energy < 0.05
        and not any(comparable(shipped + closed))
        and euler[0].angle < fourth[0].angle
        and euler[-1].angle > fourth[-1].angle
    )


def heavy_tip(of: Methods) -> bool:
    shipped, closing = of["pymunk default"], of["pymunk 10 sweeps, all of the gap"]
    dividing = ("mujoco extended", "mujoco extended, free, sparse Newton")  # they divide a step that is too long
    return (
        all(row.angle > other.angle for row, other in zip(closing, shipped, strict=True))
        and outcomes(of["pymunk extended"]) == [Outcome.UNRESOLVED]
        and all(comparable(rows) == [False, True, True] for rows in (shipped, of["pymunk tuned"], closing))
        and comparable(of["pymunk 1000 sweeps, all of the gap"]) == [False, True, False]
        and all(outcome in BROKEN for outcome in outcomes(of[f"mujoco {SWEPT.variant}"]))
        and comparable(of[f"mujoco {PATIENT.variant}"]) == [True]
        and comparable(of["mujoco tuned"]) == [False, True, True]
        and all(outcomes(of[n]) == [Outcome.UNRESOLVED, Outcome.UNRESOLVED, Outcome.FINISHED] for n in dividing)
    )


def hardened_ring(of: Methods) -> bool:
    lost = of["mujoco Newton, softening 1e-8"][0]
    return (
        stays(of["mujoco default"])
        and of["mujoco Newton, softening 1e-6"][0].angle < 1e-10
        and lost.energy > 1
        and lost.gap < 1e-3
        and lost.angle < 0.1  # rounding decides its size
    )


def beyond_the_horizon(of: Methods) -> bool:
    higher = ("mujoco tuned", "pymunk extended", "mujoco extended", "lagrange rk4 projection")
    return not any(any(comparable(of[name])) for name in ("pymunk default", "pymunk tuned", "mujoco default")) and all(
        of[name][-1].angle < 1e-3 for name in higher
    )


def hundred_links(of: Methods) -> bool:
    shipped, tuned = of["pymunk default"], of["pymunk tuned"]
    return (
        outcomes(of["mujoco default"])[:2] == [Outcome.RESET, Outcome.SATURATED]
        and outcomes(of["mujoco tuned"])[:2] == [Outcome.RESET] * 2
        and outcomes(of["lagrange euler projection"])[:2] == [Outcome.DIVERGED] * 2
        and outcomes(shipped)[:2] == outcomes(tuned)[:2] == [Outcome.TORN] * 2
        and max(row.energy for row in shipped + tuned) < 0.05
        and all(comparable(rows)[-1] for rows in of.values())
    )


def large_steps_of_discs(of: Methods) -> bool:
    gaps = [[row.gap for row in rows] for rows in of.values()]
    silent = all(
        row.outcome == Outcome.TORN and "without a warning" in row.sentence for rows in of.values() for row in rows
    )
    return silent and all(each == sorted(each, reverse=True) for each in gaps)


def polygons(rows: Mapping[Cell, Measurement]) -> bool:
    """Corners alone make the error of a coarse polygon; with 512 the step still has a part."""
    angle = {(corners, cell.every): rows[cell].angle for corners, cell in rolling.polygon_cells()}
    coarse = all(abs(angle[corners, 100] / angle[corners, 10] - 1) < 0.05 for corners in (32, 128))
    return coarse and 0.7 < angle[512, 100] / angle[512, 10] < 0.9


def softness(rows: Mapping[Cell, Measurement]) -> bool:
    """A soft contact's error is that of its time constant, a stiff one's the step's too: the shortest is not best."""
    angle = {(constant, cell.every): rows[cell].angle for constant, cell in rolling.softness_cells()}
    return (
        abs(angle[2e-2, 10] / angle[2e-2, 100] - 1) < 0.05
        and abs(angle[6e-3, 10] / angle[6e-3, 100] - 1) > 0.2
        and angle[2e-3, 10] > 2 * angle[2e-3, 100]
        and angle[2e-4, 100] > angle[6e-4, 100]
    )


def second_wheels(rows: Mapping[Cell, Measurement]) -> bool:
    """A second wheel on an axle changes no method's position error, apart from rounding."""
    return all(
        abs(rows[Cell(doubled, engine, every, "failure")].position / rows[Cell(scene, engine, every)].position - 1)
        < 0.01
        for scene, doubled in ((CarAndTrailer(), CarAndTrailer(redundant=True)), (Cart(), Cart(redundant=True)))
        for engine in (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
        for every in (1, 10)
    )


def rest_on_a_slope(of: Methods) -> bool:
    return (
        of["pymunk default"][0].position == 0
        and all(row.position < 1e-12 for row in of["mujoco default"])
        and all(row.position > 1e-7 for row in of["mujoco tuned"])
    )


def torn_by_the_crank(of: Methods) -> bool:
    broken = (*BROKEN, Outcome.DIVERGED, Outcome.BRANCH_FLIP, Outcome.SATURATED)
    return all(outcome in broken for rows in of.values() for outcome in outcomes(rows))


def late_slips(material: Material) -> bool:
    delays = skate.delays(material)
    return 0 < delays["least"] <= delays["most"] < 0.3  # s


def late_folds(material: Material) -> bool:
    return all(0.4 < late < 0.7 for late in wheels.lateness(material)["late"])  # s


def partings(material: Material) -> bool:
    return rolling.after_parting(material)["least"] > 100


def chatters(material: Material) -> bool:
    motions = material.motions(rolling.CHATTERING)
    return bool(motions) and all(rolling.absent_contact(cell, run) > 0 for cell, run in motions.items())


def one_setting_moves_each_engine(material: Material) -> bool:
    """Each engine's error goes from the first family (0.1 rad) to the second (0.02 rad) by one setting."""
    error = {cell: row.angle for cell, row in material.rows.items()}
    return (
        all(
            error[after] < min(0.02, error[before] / 2) and (error[before] > 0.1 or "the loop's pin" in name)
            for name, _, before, after in engines.MOVES
            if not after.engine.missing
        )
        and error[engines.SPRUNG["tree", 20.0]] < error[engines.SPRUNG["free", 20.0]] / 2
        and error[engines.CLOSED_AT[1, 0.0]] > 0.1
        and error[engines.CLOSED_AT[1, 0.25]] < 0.02
    )


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
        and all(
            abs(method(name).sweep().order - order) < 0.1 for name, order in ((euler, 1), (implicit, 1), (tuned, 2))
        )
        and not method(tuned).sweep().plateau > 0
        and method(tuned).sweep("reaction").plateau > 10 * at(tuned).angle
        and extended.reaction > 100 * extended.angle
    )


def map_of(subject: str) -> dict[str, dict[float, tuple[Outcome, ...]]]:
    """Outcomes of a map of the atlas by method and value, largest step first."""
    found: dict[str, dict[float, tuple[Outcome, ...]]] = {}
    for line in atlas_lines():
        if line.subject == subject:
            found.setdefault(line.method, {})[line.value] = line.told
    return found


def maps(material: Material) -> bool:
    couplers, offsets, sleighs = (map_of(subject) for subject in ("coupler", "offset", "sleigh"))
    soft, naive = couplers["mujoco default"], sleighs.pop("pymunk default")
    return (
        all(set(soft[value]) == {Outcome.TORN} for value in (min(soft), max(soft)))
        and all(told[-1].comparable for told in couplers["mujoco tuned"].values())
        and all(
            offsets[f"{name} default"][min(offsets[f"{name} default"])][-1] is Outcome.BRANCH_FLIP
            for name in ("pymunk", "mujoco")
        )
        and all(told[-1].comparable for told in offsets["pymunk tuned"].values())
        and naive[min(naive)][-1].comparable
        and not naive[max(naive)][-1].comparable
        and all(told[-1].comparable for of in sleighs.values() for told in of.values())
    )


# Page and experiment -> the predicate on the rows of its methods.
OF_METHODS: Mapping[tuple[str, str], Callable[[Methods], bool]] = {
    ("four_bar", "A parallelogram through its change points"): change_points,
    ("four_bar", "A crank driven into its limit"): torn_by_the_crank,
    ("four_bar", "Five ways to drive a crank"): driven_cranks,
    ("four_bar", "Steps far too large"): large_steps_of_four_bars,
    ("four_bar", "Too few iterations"): few_sweeps,
    ("four_bar", "Worse as the step shrinks"): cancelled_errors,
    ("n_four_bar", "Forces that have no limit"): forces_without_limit,
    ("pendulum", "Two thousand seconds of a point pendulum"): point_pendulum,
    ("pendulum", "A light chain with a heavy tip"): heavy_tip,
    ("pendulum", "A ring of a hundred links, closed by one joint"): hardened_ring,
    ("pendulum", "Beyond the horizon of the double pendulum"): beyond_the_horizon,
    ("pendulum", "A hundred links at large steps"): hundred_links,
    ("rolling", "Steps far too large"): large_steps_of_discs,
    ("skate", "At rest across a slope"): rest_on_a_slope,
}
# Page and experiment, or a part of the page -> the predicate on all that the page is written from.
OF_PAGES: Mapping[tuple[str, str], Callable[[Material], bool]] = {
    ("atlas", "the maps of couplers, slots and sleighs"): maps,
    ("engines", "one setting moves each engine"): one_setting_moves_each_engine,
    ("rolling", "Beyond the hop, and beyond the friction"): partings,
    ("rolling", "Chatter on curved ground"): chatters,
    ("rolling", "Polygons"): lambda material: polygons(material.rows),
    ("rolling", "Softer and stiffer contacts"): lambda material: softness(material.rows),
    ("settings", "the settings of a loop"): settings_of_a_loop,
    ("skate", "Friction too low to hold"): late_slips,
    ("wheels", "A reversing trailer jack-knifes"): late_folds,
    ("wheels", "Both wheels of every axle"): lambda material: second_wheels(material.rows),
}


def methods(failure: Failure, rows: Mapping[Cell, Measurement]) -> Methods:
    found: dict[str, list[Measurement]] = {}
    for row in sorted((rows[cell] for cell in failure.cells if cell in rows), key=lambda row: -row.step):
        found.setdefault(row.method, []).append(row)
    return found


def contradicted(pages: Mapping[Page, Material]) -> list[str]:
    """The claims that the rows or motions of these pages contradict or do not have, as "page: experiment"."""
    wrong = []
    for page, material in pages.items():
        claims = [(title, partial(claim, material)) for (name, title), claim in OF_PAGES.items() if name == page.name]
        for failure in page.failures:
            if claim := OF_METHODS.get((page.name, failure.title)):
                claims.append((failure.title, partial(claim, methods(failure, material.rows))))
        wrong += [f"{page.name}: {title}" for title, claim in claims if not _holds(claim)]
    return wrong


def _holds(claim: Callable[[], bool]) -> bool:
    try:
        return claim()
    except (LookupError, StopIteration):  # a method or a step of the claim was not run
        return False
