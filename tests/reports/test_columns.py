"""Tables of all engines by hand: what a column holds, errors at equal CPU time, cost at equal error, at equal step."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import pytest

from engines import Holder, mujoco, pymunk
from engines.pymunk.methods import SKATE_POINT
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.scenes.catalogue import SCENES
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Page
from reports.pages.skate.page import PAGE as SKATE
from reports.write.columns import (
    equal_cost,
    equal_error,
    equal_step,
    error_within,
    lines,
    means,
    reached,
)
from reports.write.holders import Column, column_of, told_rows, told_variant
from tests.rows import falling, row_of, table
from tests.toys import Disc, Toy

# Steps of the rows that `falling` makes, in place of those that people use.
STEPS = {"coarse": 1e-1, "usual": 1e-2, "fine": 1e-3}
POWER = (1e-2, 1e-4, 1e-6)
VARIANTS = ("default", "tuned", "extended")
KNOWN = {scene.name: scene for scene in SCENES}
FREE, SLEIGH = KNOWN["free_four_bar"], KNOWN["sleigh"]


@dataclass(frozen=True)
class Held(Toy):
    by: Holder = "engine"

    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        return self.by


class OtherDisc(Disc):
    """Another scene."""

    name = "other_disc"


def page_of(*methods: Toy, **changes) -> Page:
    engines = methods or tuple(Toy(variant, name=name) for name in ("pymunk", "mujoco") for variant in VARIANTS)
    return replace(Page("base", "Discs", "One disc.", (Disc(),), engines), **changes)


def cell_of(rows: Iterable[Measurement], steps=STEPS, **changes) -> str:
    """What the table at equal step says of MuJoCo's documented settings."""
    (text,) = equal_step([(page_of(**changes), list(rows))], steps).values()
    head, line = table(text)
    return line[head.index("mujoco documented settings")]


def tuned(step: float, **changes):
    return row_of("mujoco tuned", step=step, **changes)


@pytest.mark.parametrize(
    ("errors", "more", "words"),
    [
        (POWER, [], "0.01, 1e-4, 1e-6; order 2.0"),
        ((1e-2, 1e-13), [], "0.01, 1e-13, -; to rounding"),
        ((1e-2, 3e-5, 2e-5, 2e-5), [], "0.01, 3e-5, 2e-5; **plateau 2e-5**"),
        ((1e-2, 3e-5, 2.9e-5), [], "0.01, 3e-5, 2.9e-5; **levels off**"),
        ((1e-2, 1e-4, 1e-6, 1e-3), [], "0.01, 1e-4, 1e-6; **least at 1 ms**, then worse"),
        # Two errors that cancel at the second step: the limit is told, and that what lies below it is luck.
        ((1e-2, 1e-4, 1e-3, 1.1e-3, 1.11e-3), [], "0.01, 1e-4, 1e-3; **plateau 1.1e-3** (less is luck)"),
        # Luck is told only of errors that stand there.
        ((1e-2, 2e-3, 1.6e-3, 1e-5, 1.4e-3, 1.5e-3, 1.5e-3), [], "0.01, 2e-3, 1.6e-3; **plateau 1.5e-3**"),
        # A row at a usual step leaves the order alone.
        (POWER, [tuned(1e-4, angle=0.3, purpose="usual")], "0.01, 1e-4, 1e-6; order 2.0"),
        (
            POWER[:1],
            [tuned(1e-2, angle=1e-4, purpose="usual"), tuned(1e-3, angle=1e-6)],
            "0.01, 1e-4, 1e-6; order 2.0",
        ),
        # What fails says so in its place, and at the finest step; at all usual steps once.
        (POWER[:2], [tuned(1e-3, outcome=Outcome.TORN)], "0.01, 1e-4, torn; **torn** at 1 ms"),
        (
            (),
            [tuned(10.0**-i, outcome=Outcome.SATURATED) for i in (1, 2, 3)]
            + [tuned(10.0**-i, angle=10.0 ** (2 - i)) for i in (4, 5, 6)],
            "saturated; order 1.0",
        ),
        ((), [tuned(1e-2, outcome=o) for o in (Outcome.TORN, Outcome.TORN, Outcome.RESET)], "torn, reset"),
    ],
)
def test_a_cell_has_the_errors_at_the_usual_steps_and_what_a_smaller_step_brings(errors, more, words):
    rows = [*falling("mujoco tuned", errors), *more]
    assert cell_of(rows) == words
    if "order" in words or "**" in words:  # outcomes alone stand in the order of their rows
        assert cell_of(rows[::-1]) == words


def test_steps_are_told_where_they_were_run_and_no_other_step_stands_for_them():
    rows = falling("mujoco tuned", (*POWER, 1e-8))
    rows += [tuned(9e-2, angle=7e-3), tuned(9.95e-4, angle=8e-6)]
    assert cell_of([row for row in rows if row.step not in (1e-1, 1e-3)]).startswith("-, 1e-4, 8e-6; ")
    assert cell_of(rows, steps={"usual": 1e-2}).startswith("1e-4; ")


def test_each_engine_has_its_table_each_column_its_own_method_and_each_line_its_own_scene():
    methods = [f"{engine} {variant}" for engine in ("pymunk", "mujoco") for variant in VARIANTS]
    # Another error for each of twelve cells.
    rows = [
        row_of(method, scene=scene, step=1e-2, angle=(10 + i) * factor)
        for scene, factor in (("disc", 1e-4), ("other_disc", 1e-6))
        for i, method in enumerate(methods)
    ]
    tables = equal_step([(page_of(scenes=(Disc(), OtherDisc())), rows)], {"usual": 1e-2}, "folder/")
    assert list(tables) == ["pymunk", "mujoco"]
    for engine, first in (("pymunk", 0), ("mujoco", 3)):
        head, *body = table(tables[engine])
        assert head == ["scene", *(f"{engine} {name}" for name in Column if name not in ("naive", ""))]
        for line, name, power in zip(body, ("disc", "other disc"), ("e-3", "e-5"), strict=True):
            assert line[0] == f"[{name}](folder/base.md), rad"
            assert line[1:] == [f"1.{first + i}{power}".replace("1.0e", "1e") for i in range(3)]


@pytest.mark.parametrize(
    ("variant", "by", "column"),
    [
        ("default", "engine", Column.SHIPPED),
        ("default", "ours", Column.NAIVE),
        ("tuned", "engine", Column.SETTINGS),
        ("tuned", "engine, our rows", Column.CODE),
        ("stiffer", "engine", Column.SETTINGS),
        ("extended", "engine", Column.CODE),
        ("extended", "ours", Column.NAIVE),
    ],
)
def test_who_holds_the_joints_decides_in_which_column_a_method_stands(variant, by, column):
    assert column_of(Disc(), Held(variant, by=by)) is column


def test_a_users_trick_does_not_bear_the_usual_name_of_an_engine_on_any_page():
    assert [told_variant(scene, pymunk.DEFAULT) for scene in (FREE, SLEIGH)] == ["default", "naive"]
    assert told_variant(SLEIGH, mujoco.DEFAULT) == "default"  # a contact of its own
    tricks = [told_variant(SLEIGH, Held(variant, by="ours")) for variant in ("default", "tuned")]
    assert tricks == ["naive", "naive, tuned"]  # rows of one name would be taken for one method
    assert told_variant(SLEIGH, SKATE_POINT) == SKATE_POINT.variant
    cell = Cell(SLEIGH, pymunk.DEFAULT, 1)
    assert told_rows({cell: row_of("pymunk default")})[cell].method == "pymunk naive"


def test_a_cell_is_empty_where_the_engine_has_no_such_joint_and_says_what_our_adapter_does_not_build():
    naive = (Held("default", by="ours"), Held("tuned", by="engine, our rows"), Held("extended", by="engine, our rows"))
    rows = [*falling("toy default", POWER), *falling("toy tuned", POWER), *falling("toy extended", POWER)]
    text = equal_cost([(page_of(*naive, Toy("default", name="other")), [*rows, *falling("other default", POWER)])])
    head, line = table(text)
    assert head == ["scene", "toy with our code", "other as shipped"]
    both = [(page_of(*naive), rows), (page_of(*map(Toy, VARIANTS), scenes=(OtherDisc(),)), [
        replace(row, scene="other_disc") for row in rows
    ])]  # fmt: skip
    head, line, other = table(equal_cost(both))
    assert line[1:3] == ["*no such joint*"] * 2
    assert "*no such joint*" not in other
    for sentence, word in (("it has none: https://its.documentation", "no such joint"), ("not tried", "not built")):
        unbuilt = [
            replace(row, outcome=Outcome.UNSUPPORTED, sentence=sentence) for row in falling("toy default", POWER)
        ]
        assert table(equal_cost([(page_of(Toy("default")), unbuilt)]))[1][1] == f"*{word}*"


def test_within_a_cpu_time_the_least_error_counts_that_no_smaller_step_exceeds():
    rows = falling("mujoco tuned", (1e-2, 1e-5, 1e-3, 1e-6))  # they cost 1, 10, 100 and 1000 ms; the second is luck
    assert error_within(rows, "angle", 0.1) == 1e-3
    assert error_within(rows, "angle", 0.01) == 1e-3
    assert error_within(rows, "angle", 0.001) == 1e-2
    assert error_within(rows, "angle", 0.0009) == math.inf
    assert error_within(rows, "angle", 9.0) == 1e-6
    torn = [*rows[:3], replace(rows[3], outcome=Outcome.TORN)]
    assert error_within(torn, "angle", 9.0) == math.inf


def test_a_line_of_the_picture_never_runs_backwards():
    rough = falling("mujoco extended", (1e-2, 1e-5, 1e-7))
    rough[0] = replace(rough[0], cpu=0.05)  # a rough run made the largest step dearer than the next
    points = reached([rough, falling("mujoco tuned", (1e-1, 1e-3, 1e-3))], "angle")
    assert points == sorted(points)
    assert [error for _, error in points] == sorted((error for _, error in points), reverse=True)
    assert min(error for _, error in points) == 1e-7


def test_the_cost_of_an_error_is_that_of_the_cheapest_method_of_its_column():
    methods = (Toy("default"), Held("tuned", by="engine, our rows"), Held("extended", by="engine, our rows"))
    rows = [
        *falling("toy default", (1.0, 0.5)),
        *falling("toy tuned", (1e-3, 1e-5)),
        *falling("toy extended", (1e-10,)),
    ]
    rows[-1] = replace(rows[-1], cpu=0.05)
    head, line = table(equal_error([(page_of(*methods), rows)])["toy"])
    assert head == ["scene", "toy as shipped", "toy with our code"]
    assert line[1:] == ["-", "1, 10, 50, 50"]


def test_a_stand_in_for_documented_settings_is_named_and_a_usual_variant_is_not():
    """One skate in MuJoCo had three numbers on three pages, two of them of a blade that no cell named."""
    (line,) = (
        line
        for line in lines([(SKATE, falling("mujoco default", POWER, "position", scene="sleigh"))])
        if line.engine == "mujoco"
    )
    assert means(line, Column.SETTINGS) == ", contact, *friction blade*"
    assert means(line, Column.SHIPPED) == ", contact"
    assert means(line, Column.CODE) == ""
