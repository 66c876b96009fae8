"""Tests of tables, CSV files and columns of engines; each field of each row has a different number.

The printed tables are in tests/golden/tables.md; comments beside the rows state what the tables must show.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import pytest

from engines import Enforcement, mujoco, pymunk
from engines.capability import Capability, Lack
from engines.pymunk.methods import SKATE_POINT
from engines.registry import OTHERS
from reference.joints import Joint, Pin
from reference.mechanism import Mechanism
from reference.scenes.catalogue import SCENES
from reports.model.cells import Cell
from reports.model.convergence import Sweep, Verdict
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.model.quantities import quantity
from reports.pages.skate.page import PAGE as SKATE
from reports.write import columns as engine_tables
from reports.write import csv_files, row_tables, tables
from reports.write.columns import Column
from reports.write.experiments import render_experiment, without_incomparable_errors
from reports.write.page_tables import advice, advice_table, compared_step, reliable, scene_table
from tests.present import present
from tests.rows import falling, row, row_of, table
from tests.toys import Disc, OtherDisc, Toy

NAN = math.nan
# Steps of the rows from `falling`, instead of the steps that people use.
STEPS = {"coarse": 1e-1, "usual": 1e-2, "fine": 1e-3}
POWER = (1e-2, 1e-4, 1e-6)
VARIANTS = ("default", "tuned", "extended")
KNOWN = {scene.name: scene for scene in SCENES}
FREE, SLEIGH = KNOWN["free_four_bar"], KNOWN["sleigh"]


@dataclass(frozen=True)
class HeldBy(Toy):
    by: Enforcement = "engine"

    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return self.by


class WithoutPin(Toy):
    capability = Capability("toy", (), lacks={Pin: Lack("toy has no pin", "https://its.documentation")})


def page_of(*methods: Toy, **changes) -> Page:
    engines = methods or tuple(Toy(variant, name=name) for name in ("pymunk", "mujoco") for variant in VARIANTS)
    return replace(Page("base", "Discs", "One disc.", (Disc(),), engines), **changes)


@pytest.mark.parametrize(
    ("value", "text", "digits"),
    [
        *((0.0, "0", 2), (1.234e-7, "1.2e-7", 2), (0.01, "0.01", 2), (0.00999, "0.01", 2), (99.6, "100", 2)),
        *((100.0, "100", 2), (9999.0, "9999", 2), (NAN, "-", 2), (math.inf, "∞", 2), (1.26e-4, "1e-4", 1)),
        (0.1256, "0.126", 3),
    ],
)
def test_a_number_has_the_requested_significant_digits(value, text, digits):
    assert tables.number(value, digits) == text


def sweep(verdict: Verdict, order: float = NAN, points: int = 0, plateau: float = NAN, best: float = 1.7e-5) -> Sweep:
    return Sweep("s", "toy", "default", quantity("angle"), verdict, order, points, 0.13, plateau, 1e-7, best, 1e-3)


def tuned(step: float, **changes):
    return row_of("mujoco tuned", step=step, **changes)


def at_steps() -> Iterator[list[Measurement]]:
    """Sets of rows of MuJoCo's documented settings; each set gives a different cell in the table at equal step."""
    yield falling("mujoco tuned", POWER)
    yield falling("mujoco tuned", (1e-2, 1e-13))  # falls to rounding
    yield falling("mujoco tuned", (1e-2, 3e-5, 2e-5, 2e-5))
    yield falling("mujoco tuned", (1e-2, 3e-5, 2.9e-5))  # The errors level off.
    yield falling("mujoco tuned", (1e-2, 1e-4, 1e-6, 1e-3))  # The least error is at 1 ms.
    # Two errors cancel at the second step, so the cell has the plateau and a remark on this step.
    yield falling("mujoco tuned", (1e-2, 1e-4, 1e-3, 1.1e-3, 1.11e-3))
    # Two errors cancel at a step that is not in the cell, so there is no remark.
    yield falling("mujoco tuned", (1e-2, 2e-3, 1.6e-3, 1e-5, 1.4e-3, 1.5e-3, 1.5e-3))
    # A row with the purpose "usual" does not change the order.
    yield [*falling("mujoco tuned", POWER), tuned(1e-4, angle=0.3, purpose="usual")]
    yield [*falling("mujoco tuned", POWER[:1]), tuned(1e-2, angle=1e-4, purpose="usual"), tuned(1e-3, angle=1e-6)]
    # A failed run has its outcome; equal outcomes at all steps are printed once.
    yield [*falling("mujoco tuned", POWER[:2]), tuned(1e-3, outcome=Outcome.TORN)]
    failed = [tuned(10.0**-i, outcome=Outcome.SATURATED) for i in (1, 2, 3)]
    yield failed + [tuned(10.0**-i, angle=10.0 ** (2 - i)) for i in (4, 5, 6)]
    yield [tuned(1e-2, outcome=outcome) for outcome in (Outcome.TORN, Outcome.TORN, Outcome.RESET)]
    # A step that was not run is not replaced by another.
    moved = [row for row in falling("mujoco tuned", (*POWER, 1e-8)) if row.step not in (1e-1, 1e-3)]
    yield [*moved, tuned(9e-2, angle=7e-3), tuned(9.95e-4, angle=8e-6)]


def cell_of(rows: Iterable[Measurement]) -> str:
    (text,) = engine_tables.equal_step([(page_of(), list(rows))], STEPS).values()
    head, line = table(text)
    return line[head.index("mujoco documented settings")]


def printed() -> Iterator[str]:
    yield "## On a terminal"
    yield "\n".join(
        tables.text_table(["case", "error"], [["四節", "1e-3"], ["θ", "12"]], 1, (" ┃ ", " │ "), ("━", "━╇━"))
    )
    yield "\n".join(tables.text_table(["a", "b"], [["wide", "-"]]))
    yield tables.markdown(["a", "b"], [["1|2", "3\n4"]], left=1)
    yield "## Each quantity under its name"
    yield tables.markdown(row_tables.ERROR_HEADER, row_tables.error_rows([row()]))
    yield "## Sweeps, and those whose finest step is torn"
    for item in (
        *(sweep(Verdict.FALLS, 1.994, 4), sweep(Verdict.FALLS), sweep(Verdict.PLATEAU, 1.1, 3, 2.3e-5)),
        *(sweep(Verdict.ROUNDING, 3.9, 3), sweep(Verdict.LEVELS, 1.1, 3), sweep(Verdict.GROWS)),
        *(sweep(Verdict.ERRATIC), sweep(Verdict.TOO_FEW, best=NAN)),
    ):
        yield f"- {row_tables.sweep_words(item)} | {row_tables.sweep_words(item, 'torn')}"
    yield "## Outcomes by step"
    yield row_tables.outcome_grid(
        [
            row_of("a x", step=1e-3, angle=1.3e-5),
            row_of("a x", step=1e-1, outcome=Outcome.TORN, gap=1.7e-2),
            row_of("b x", step=1e-2, outcome=Outcome.SATURATED),
            row_of("b x", step=1e-3, outcome=Outcome.TORN, gap=NAN),
            row_of("b x", step=1e-1, outcome=Outcome.PLATEAU, angle=2.3e-4),
        ]
    )
    yield "## Summary"
    rows = [
        *falling("toy default", (1e-2, 1e-4, 1e-6)),
        row_of("toy default", step=1e-4, angle=1e-9, outcome=Outcome.TORN),
        *falling("toy soft", (1e-2, 3e-5, 3e-5, 3e-5)),
        *falling("toy exact", (1e-3, 1e-13)),
        row_of("toy lost", outcome=Outcome.DIVERGED),
    ]
    yield tables.markdown(row_tables.SUMMARY_HEADER, row_tables.summary_rows(rows))
    yield "## Scenes: plain, with the enforcement of joints, with what is declared (2e-5 of a, 1e-6 of b: marked)"
    expected: dict[str, Any] = {"gap": 1.7e-3, "slip": NAN, "reaction": NAN}
    rows = [*falling("a x", POWER, **expected), *falling("b y", (1e-2, 3e-5, 3e-5, 3e-5), **expected)]
    rows += [row_of("c z", step=1e-3, outcome=Outcome.TORN, **expected)]
    yield scene_table(rows, "angle")
    yield scene_table(rows, "angle", {"a x": "engine", "b y": "our code"})
    rows = [*falling("a soft", (1e-2, 3e-5, 3e-5, 3e-5)), *falling("b wrong", (1e-2, 3e-5, 3e-5, 3e-5))]
    yield scene_table(rows, "angle", declared=lambda method, step: 2e-5 if method == "a soft" else 1e-6)
    yield "## Advice: the second method costs three times as much"
    rows = [
        *falling("a slow", (1e-1, 1e-3, 1e-5)),
        *[replace(row, cpu=3 * row.cpu) for row in falling("a fast", (1e-5, 1e-7, 1e-10))],
        *falling("b only", (1e-1, 1e-2, 5e-3)),
    ]
    yield advice_table(advice(rows, "angle"), "angle", {"a fast": "our code"})
    yield "## Cells at equal step"
    yield "\n".join(f"- {cell_of(rows)}" for rows in at_steps())
    yield "## Each engine its table, each column its method, each line its scene: another error in each of twelve cells"
    rows = [
        row_of(f"{engine} {variant}", scene=scene, step=1e-2, angle=(10 + 3 * j + i) * factor)
        for scene, factor in (("disc", 1e-4), ("other_disc", 1e-6))
        for j, engine in enumerate(("pymunk", "mujoco"))
        for i, variant in enumerate(VARIANTS)
    ]
    yield from engine_tables.equal_step([(page_of(scenes=(Disc(), OtherDisc())), rows)], {"usual": 1e-2}).values()
    yield "## No such joint: the engine's own columns are empty where our code alone holds the joint"
    naive = (
        HeldBy("default", by="ours"),
        HeldBy("tuned", by="engine, our rows"),
        HeldBy("extended", by="engine, our rows"),
    )
    rows = [row for variant in VARIANTS for row in falling(f"toy {variant}", POWER)]
    other = [replace(row, scene="other_disc") for row in rows]
    beside = [*rows, *falling("other default", POWER)]
    yield engine_tables.equal_cost([(page_of(*naive, Toy("default", name="other")), beside)])
    yield engine_tables.equal_cost(
        [(page_of(*naive), rows), (page_of(*map(Toy, VARIANTS), scenes=(OtherDisc(),)), other)]
    )
    yield "## No such joint in the engine, and not built by the adapter"
    unbuilt = [replace(row, outcome=Outcome.UNSUPPORTED) for row in falling("toy default", POWER)]
    for engine in (WithoutPin("default"), Toy("default")):
        yield engine_tables.equal_cost([(page_of(engine), unbuilt)])
    yield "## Cost at equal error: of the cheapest method of a column"
    rows = [*falling("toy default", (1.0, 0.5)), *falling("toy tuned", (1e-3, 1e-5))]
    rows += [replace(row, cpu=0.05) for row in falling("toy extended", (1e-10,))]
    yield engine_tables.equal_error([(page_of(Toy("default"), *naive[1:]), rows)])["toy"]
    yield "## CSV: sorted, whatever order rows come in"
    rows = [row_of(f"{engine} x", scene=scene, every=every) for engine in "ba" for scene in "dc" for every in (3, 1)]
    for timings in (False, True):
        yield csv_files.as_csv(rows[::-1], timings, header="a date\na machine")
        assert csv_files.as_csv(rows, timings) == csv_files.as_csv(rows[::-1], timings)
    yield csv_files.descriptions_csv([row(), row(angle=1.0), row(settings="Toy(order=4.0)")])


def test_printed_tables_equal_the_golden_file(golden):
    text = "\n\n".join(printed())
    golden("tables.md", text)
    for described in ("Disc(rate=2.0)", "Toy(order=2.0)"):
        assert hashlib.sha256(described.encode()).hexdigest()[:8] in text


COLUMNS: tuple[tuple[str, Enforcement, Column], ...] = (
    ("default", "engine", Column.SHIPPED),
    ("default", "ours", Column.NAIVE),
    ("tuned", "engine", Column.SETTINGS),
    ("tuned", "engine, our rows", Column.CODE),
    ("stiffer", "engine", Column.SETTINGS),
    ("extended", "engine", Column.CODE),
    ("extended", "ours", Column.NAIVE),
)


def test_the_enforcement_of_joints_determines_the_column_of_a_method():
    for variant, by, column in COLUMNS:
        assert engine_tables.column_of(Disc(), HeldBy(variant, by=by)) is column
    cells = [Cell(FREE, HeldBy("x", by="ours"), 1), Cell(FREE, HeldBy("x"), 1), Cell(FREE, HeldBy("x", by="ours"), 10)]
    assert engine_tables.enforcement_by_method(cells) == {"toy x": "our code or engine"}


def test_a_naive_method_is_never_printed_under_a_usual_name():
    assert [engine_tables.displayed_variant(scene, pymunk.DEFAULT) for scene in (FREE, SLEIGH)] == ["default", "naive"]
    assert engine_tables.displayed_variant(SLEIGH, mujoco.DEFAULT) == "default"
    tricks = [engine_tables.displayed_variant(SLEIGH, HeldBy(variant, by="ours")) for variant in ("default", "tuned")]
    assert tricks == ["naive", "naive, tuned"]
    assert engine_tables.displayed_variant(SLEIGH, SKATE_POINT) == SKATE_POINT.variant
    cell = Cell(SLEIGH, pymunk.DEFAULT, 1)
    assert engine_tables.with_displayed_variants({cell: row_of("pymunk default")})[cell].method == "pymunk naive"
    # A remark names an unusual variant, such as the friction blade.
    (line,) = (
        line
        for line in engine_tables.engine_lines([(SKATE, falling("mujoco default", POWER, "position", scene="sleigh"))])
        if line.engine == "mujoco"
    )
    assert engine_tables.remarks_of(line, Column.SETTINGS) == ", contact, *friction blade*"
    assert engine_tables.remarks_of(line, Column.SHIPPED) == ", contact"
    assert engine_tables.remarks_of(line, Column.CODE) == ""
    # Exudyn has a joint for a skate, so no contact replaces it.
    of_exudyn = {Column.SHIPPED: ((next(engine for engine in OTHERS if engine.name == "exudyn"), ()),)}
    assert engine_tables.remarks_of(engine_tables.EngineLine(SKATE, SLEIGH, "exudyn", of_exudyn), Column.SHIPPED) == ""


def test_an_error_within_a_cpu_time_counts_only_if_no_smaller_step_exceeds_it():
    rows = falling("mujoco tuned", (1e-2, 1e-5, 1e-3, 1e-6))
    for cost, error in ((0.1, 1e-3), (0.01, 1e-3), (0.001, 1e-2), (0.0009, math.inf), (9.0, 1e-6)):
        assert engine_tables.error_within(rows, "angle", cost) == error
    torn = [*rows[:3], replace(rows[3], outcome=Outcome.TORN)]
    assert engine_tables.error_within(torn, "angle", 9.0) == math.inf


def test_a_step_is_not_reliable_if_a_smaller_step_has_a_larger_error():
    lucky = falling("a lucky", (1e-5, 1e-2, 1e-3))
    assert [row.step for row in reliable(lucky, "angle", 1e-2)] == [1e-3, 1e-2, 1e-1]
    assert [row.step for row in reliable(lucky, "angle", 5e-3)] == [1e-3]
    assert reliable(lucky, "angle", 1e-4) == []
    for change in ({"outcome": Outcome.TORN}, {"angle": NAN}):
        assert reliable([*lucky[:2], replace(lucky[2], **change)], "angle", 1.0) == []


def test_among_equal_costs_the_first_method_of_the_page_is_recommended():
    late, early = row_of("a late", angle=1e-10, cpu=1.0), row_of("a early", angle=1e-10, cpu=1.2)
    for rows, order, expected in (
        ((late, early), ("a early", "a late"), "a early"),
        ((late, early), ("a late", "a early"), "a late"),
        ((late, replace(early, cpu=1.3)), ("a early", "a late"), "a late"),
    ):
        (result,) = advice(rows, "angle", order)
        assert present(result.row).method == expected
    assert compared_step([row_of("a x", step=step) for step in (3e-4, 2.9e-3)]) == 2.9e-3


def test_an_experiment_without_comparable_samples_has_no_errors():
    @dataclass(frozen=True)
    class Ended(Disc):
        @property
        def comparable_until(self) -> float:  # type: ignore[override]
            return 0.0

    cell = Cell(Ended(), Toy(), 1, "failure")
    row = row_of("toy default", angle=0.0)
    assert math.isnan(without_incomparable_errors(cell, row).angle)
    assert without_incomparable_errors(cell, row).gap == row.gap
    assert without_incomparable_errors(replace(cell, scene=Disc()), row) == row
    experiment = render_experiment(Failure("T", "E", (cell,)), Material({cell: row}))
    assert "- rad" in experiment.grid
    assert "0 rad" not in experiment.grid
