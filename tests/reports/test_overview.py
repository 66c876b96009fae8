"""The overview and the pages' sentences: each cell by hand, from its own scene's and its own method's rows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import pytest

from engines import Holder
from reference.joints import Joint
from reference.mechanism import Mechanism
from reports.model.outcomes import Outcome
from reports.model.page import Page
from reports.write.page_tables import overviews
from reports.write.templates import marks, with_part
from tests.rows import falling, row_of, table
from tests.toys import Disc, Toy

VARIANTS = ("default", "tuned", "extended")


class OtherDisc(Disc):
    """Another scene.

    Of which only the first paragraph is told.
    """

    name: ClassVar[str] = "other_disc"
    source: ClassVar[str] = "invented too"


PAGE = Page("base", "Discs", "One disc.", (Disc(), OtherDisc()), (Toy(),))
# Steps of the rows that `falling` makes, in place of those that people use.
STEPS = {"coarse": 1e-1, "usual": 1e-2, "fine": 1e-3}


def cell_of(rows, quantity: str = "angle", method: str = "mujoco tuned", steps=STEPS, page: Page = PAGE) -> str:
    """The overview's cell of one method."""
    engine, variant = method.split(" ", 1)
    head, line = table(overviews([(replace(page, quantity=quantity), rows)], steps)[engine])
    return line[head.index(f"{engine} {variant}")]


POWER = (1e-2, 1e-4, 1e-6)


def tuned(step: float, **changes):
    return row_of("mujoco tuned", step=step, **changes)


@pytest.mark.parametrize(
    ("errors", "more", "words"),
    [
        (POWER, [], "0.01, 1.0e-4, 1.0e-6; order 2.0"),
        ((1e-2, 1e-13), [], "0.01, 1.0e-13, -; to rounding"),
        ((1e-2, 3e-5, 2e-5, 2e-5), [], "0.01, 3.0e-5, 2.0e-5; **plateau 2.0e-5**"),
        ((1e-2, 3e-5, 2.9e-5), [], "0.01, 3.0e-5, 2.9e-5; **levels off**"),
        ((1e-4, 1e-3), [], "1.0e-4, 1.0e-3, -; **least at 100 ms**, then worse"),
        ((1e-2, 1e-4, 1e-1), [], "0.01, 1.0e-4, 0.1; **least at 10 ms**, then worse"),
        ((1e-2, 1e-4, 1e-6, 1e-3), [], "0.01, 1.0e-4, 1.0e-6; **least at 1 ms**, then worse"),
        ((1e-2,), [], "0.01, -, -"),
        # Two errors that cancel at the second step: the limit is told, and that what lies below it is luck.
        ((1e-2, 1e-4, 1.0e-3, 1.1e-3, 1.11e-3), [], "0.01, 1.0e-4, 1.0e-3; **plateau 1.1e-3** (less is luck)"),
        ((1e-2, 1e-3, 1.0e-5, 1.1e-3, 1.2e-3, 1.2e-3), [], "0.01, 1.0e-3, 1.0e-5; **plateau 1.2e-3** (less is luck)"),
        # Luck is told only of errors that stand there.
        ((1e-2, 2e-3, 1.6e-3, 1e-5, 1.4e-3, 1.5e-3, 1.5e-3), [], "0.01, 2.0e-3, 1.6e-3; **plateau 1.5e-3**"),
        # A row at a usual step leaves the order alone.
        (POWER, [tuned(1e-4, angle=0.3, purpose="usual")], "0.01, 1.0e-4, 1.0e-6; order 2.0"),
        (
            POWER[:1],
            [tuned(1e-2, angle=1e-4, purpose="usual"), tuned(1e-3, angle=1e-6)],
            "0.01, 1.0e-4, 1.0e-6; order 2.0",
        ),
        # What fails says so in its place, and at the finest step; at all usual steps once.
        (POWER[:2], [tuned(1e-3, outcome=Outcome.TORN)], "0.01, 1.0e-4, torn; **torn** at 1 ms"),
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
    assert cell_of([row for row in rows if row.step not in (1e-1, 1e-3)]).startswith("-, 1.0e-4, 8.0e-6; ")
    assert cell_of(rows, steps={"usual": 1e-2}).startswith("1.0e-4; ")


def test_where_nothing_ran_there_is_a_dash():
    elsewhere = replace(PAGE, name="other", scenes=(OtherDisc(),))
    rows = [row_of("mujoco tuned", outcome=Outcome.TORN)]
    both = [(PAGE, rows), (elsewhere, [row_of("mujoco default", scene="other_disc")])]
    assert [line[1:] for line in table(overviews(both, STEPS)["mujoco"])[1:]] == [["-", "torn"], ["-", "-"]]


def test_the_quantity_of_the_page_is_told_and_its_unit_beside_the_scene():
    rows = falling("mujoco tuned", (1e-3, 1e-5), "position", angle=7.0)
    assert cell_of(rows, "position") == "1.0e-3, 1.0e-5, -; order 2.0"
    for quantity, unit in (("position", "m"), ("angle", "rad")):
        (text,) = overviews([(replace(PAGE, quantity=quantity), rows)], folder="there/").values()
        assert table(text)[1][0] == f"[disc](there/base.md), {unit}"


def test_each_engine_has_its_table_each_column_its_own_method_and_each_line_its_own_scene():
    methods = [f"{engine} {variant}" for engine in ("pymunk", "mujoco") for variant in VARIANTS]
    # Another error for each of twelve cells.
    rows = [
        row_of(method, scene=scene, step=1e-2, angle=(10 + i) * factor)
        for scene, factor in (("disc", 1e-4), ("other_disc", 1e-6))
        for i, method in enumerate(methods)
    ]
    tables = overviews([(PAGE, rows)], {"usual": 1e-2}, "folder/")
    assert list(tables) == ["pymunk", "mujoco"]
    for engine, first in (("pymunk", 0), ("mujoco", 3)):
        head, *lines = table(tables[engine])
        assert head == ["scene", *(f"{engine} {variant}" for variant in VARIANTS)]
        for line, name, power in zip(lines, ("disc", "other disc"), ("e-3", "e-5"), strict=True):
            assert line[0] == f"[{name}](folder/base.md), rad"
            assert line[1:] == [f"1.{first + i}{power}" for i in range(3)]


def test_an_engine_from_elsewhere_has_its_table_with_the_variants_that_it_has():
    rows = [row_of(f"elsewhere {name}", step=1e-2, angle=1e-3) for name in ("d", "a", "b", "c")]
    rows += [row_of(f"known {name}", step=1e-2) for name in ("extended", "another", "default")]
    tables = overviews([(PAGE, rows)])
    assert table(tables["elsewhere"])[0] == ["scene", "elsewhere d", "elsewhere a", "elsewhere b"]
    assert table(tables["known"])[0] == ["scene", "known default", "known extended"]


@dataclass(frozen=True)
class Held(Toy):
    by: Holder = "engine"

    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        return self.by


@pytest.mark.parametrize(
    ("variant", "by", "words"),
    [
        ("default", "engine", "engine"),
        ("default", "ours", "ours, a user's trick"),
        ("default", "engine, our rows", "engine, our rows"),
        ("tuned", "engine, our rows", "engine, our rows"),
        ("extended", "ours", "ours"),
    ],
)
def test_a_cell_ends_with_who_holds_the_joints_and_a_shipped_engines_cell_with_whose_trick_it_is(variant, by, words):
    others = {"default": "tuned", "tuned": "extended", "extended": "default"}
    engines = (Held(others[variant]), Held(variant, by=by))
    page = replace(PAGE, engines=engines)
    rows = falling(f"toy {variant}", (1e-2, 1e-4, 1e-6))
    assert cell_of(rows, method=f"toy {variant}", page=page) == f"0.01, 1.0e-4, 1.0e-6; order 2.0; {words}"
    torn = [replace(row, outcome=Outcome.TORN) for row in rows]
    assert cell_of(torn, method=f"toy {variant}", page=page) == f"torn; {words}"
    unbuilt = [replace(row, outcome=Outcome.UNSUPPORTED) for row in rows]
    assert cell_of(unbuilt, method=f"toy {variant}", page=page) == "unsupported"


def test_a_document_has_a_text_between_its_marks_and_nothing_else_changed():
    (begin, end), (other, last) = marks("table"), marks("index")
    # It has several parts, and may end one before it begins.
    text = f"{end}\n{other}\nkept\n{last}\n{begin}\nold\n{end}\n{other}\n{last}"
    assert with_part(text, "table", "new") == text.replace("old", "new")
    for lacking, part in ((text.replace(begin, ""), "table"), (text.replace(end, ""), "table"), (text, "another")):
        with pytest.raises(ValueError, match="lacks the marks"):
            with_part(lacking, part, "new")
