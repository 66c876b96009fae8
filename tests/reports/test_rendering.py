"""A page's rows, its sentences and files, and the overview: each cell from its own scene's and method's rows."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, replace
from typing import ClassVar

import pytest

from engines import Holder
from reference.joints import Joint
from reference.mechanism import Mechanism
from reports.model.cells import Cell
from reports.model.convergence import Verdict
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation, Page
from reports.pages.index import render_readme
from reports.pages.rendering import render_all, render_page
from reports.write.page_tables import overviews
from reports.write.provenance import machine
from reports.write.rows import lookups
from reports.write.templates import marks
from reports.write.unmeasured import UNMEASURED
from tests.rows import falling, row_of, table
from tests.toys import Disc, Toy

README = "\n".join(mark for name in ("findings", "overview") for mark in marks(name))


class OtherDisc(Disc):
    """Another scene.

    Of which only the first paragraph is told.
    """

    name: ClassVar[str] = "other_disc"
    source: ClassVar[str] = "invented too"


PAGE = Page("base", "Discs", "One disc.", (Disc(), OtherDisc()), (Toy(),))
# Steps of the rows that `falling` makes, in place of those that people use.
STEPS = {"coarse": 1e-1, "usual": 1e-2, "fine": 1e-3}


DISC, OTHER = Disc(), OtherDisc()


CELLS = {
    Cell(scene, Toy(variant), every): row_of(
        f"mujoco {variant}", scene=scene.name, every=every, step=0.1 / every, angle=angle / every**2, cpu=angle
    )
    for scene, factor in ((DISC, 1.0), (OTHER, 0.1))
    for variant, angle in (("default", 1.1e-2 * factor), ("tuned", 1.3e-3 * factor))
    for every in (1, 10, 100)
}


def test_sentences_take_the_rows_of_the_scene_and_method_that_they_name():
    words = lookups(Material(CELLS), (DISC, OTHER))
    best = words["best"]("disc", "mujoco", "default")
    assert (best.scene, best.variant, best.angle) == ("disc", "default", pytest.approx(1.1e-6))
    assert words["best"]("other_disc", "mujoco", "tuned").angle == pytest.approx(1.3e-8)
    assert words["best"]("disc", "pymunk", "tuned") is UNMEASURED
    at = words["at"]("disc", "mujoco", "tuned", 10)
    assert (at.scene, at.variant, at.every) == ("disc", "tuned", 10)
    assert words["at"]("disc", "mujoco", "tuned", 7) is UNMEASURED
    sweep = words["sweep"]("other_disc", "mujoco", "tuned")
    assert (sweep.scene, sweep.variant, sweep.quantity.name) == ("other_disc", "tuned", "angle")
    assert (sweep.best, sweep.verdict) == (pytest.approx(1.3e-8), Verdict.FALLS)
    assert words["sweep"]("disc", "mujoco", "tuned", "gap").quantity.name == "gap"
    assert words["sweep"]("disc", "pymunk", "tuned") is UNMEASURED
    assert words["ended"]("disc", "mujoco", "tuned") == ["finished"]
    only = lookups(Material(CELLS), (OTHER,))
    assert only["best"]("disc", "mujoco", "default") is UNMEASURED


def test_a_page_of_two_scenes_has_in_its_tables_the_rows_of_the_advised_one_alone():
    for advised, errors in (("disc", ["1.1e-6", "1.3e-7"]), ("other_disc", ["1.1e-7", "1.3e-8"])):
        text = render_page(replace(PAGE, advised=advised), Material(CELLS), "the command")["base.md"]
        assert not {"saturated", "torn"} & set(re.findall(r"\w+", text))
        _, *lines = table(text.split("at a step of")[1].split("\n\n")[1])
        assert [line[1] for line in lines] == errors


def test_a_page_judges_by_the_quantity_that_it_compares():
    errors = falling("mujoco default", (1e-2, 3e-5, 3e-5, 3e-5), "position")
    errors = [replace(r, angle=1e-2 * r.step**2) for r in errors]
    rows = {Cell(DISC, Toy(), 10**i): r for i, r in enumerate(errors)}
    for quantity, words in (("position", "plateau **3e-5**"), ("angle", "order 2.0")):
        page = replace(PAGE, scenes=(DISC,), quantity=quantity)
        text = render_page(page, Material(rows), "the command")["base.md"]
        assert words in next(line for line in text.splitlines() if line.startswith("| mujoco default"))


def test_the_readme_is_the_same_after_a_run_that_took_another_time():
    slower = {cell: replace(row, cpu=7 * row.cpu, build=3.0, runs=9) for cell, row in CELLS.items()}
    assert render_readme(README, {PAGE: Material(slower)}) == render_readme(README, {PAGE: Material(CELLS)})
    worse = {cell: replace(row, angle=7 * row.angle) for cell, row in CELLS.items()}
    assert render_readme(README, {PAGE: Material(worse)}) != render_readme(README, {PAGE: Material(CELLS)})


def test_all_files_end_with_one_end_of_line_and_have_every_row_once():
    keyed = {cell: replace(r, key=str(i)) for i, (cell, r) in enumerate(CELLS.items())}
    files = render_all({PAGE: Material(keyed), replace(PAGE, title="Again"): Material(keyed)}, "the command")
    assert {"index.md", "base.md", "errors.csv", "timings.csv", "descriptions.csv"} <= set(files)
    for name, text in files.items():
        assert text.endswith("\n"), name
        assert not text.endswith("\n\n"), name
    for name in ("errors.csv", "timings.csv"):
        lines = [line for line in files[name].splitlines() if not line.startswith("#")]
        found = list(csv.DictReader(lines))
        assert sorted((r["scene"], r["variant"], r["every"]) for r in found) == sorted(
            (r.scene, r.variant, str(r.every)) for r in CELLS.values()
        )
    assert "angle" not in files["timings.csv"].splitlines()[-1]
    assert all(words in files["timings.csv"] for words in ("the command", machine()))


VARIANTS = ("default", "tuned", "extended")


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


def test_where_nothing_ran_there_is_a_dash():
    elsewhere = replace(PAGE, name="other", scenes=(OtherDisc(),))
    rows = [row_of("mujoco tuned", outcome=Outcome.TORN)]
    both = [(PAGE, rows), (elsewhere, [row_of("mujoco default", scene="other_disc")])]
    assert [line[1:] for line in table(overviews(both, STEPS)["mujoco"])[1:]] == [["-", "torn"], ["-", "-"]]


def test_the_quantity_of_the_page_is_told_and_its_unit_beside_the_scene():
    rows = falling("mujoco tuned", (1e-3, 1e-5), "position", angle=7.0)
    assert cell_of(rows, "position") == "1e-3, 1e-5, -; order 2.0"
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
            assert line[1:] == [f"1.{first + i}{power}".replace("1.0e", "1e") for i in range(3)]


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
    assert cell_of(rows, method=f"toy {variant}", page=page) == f"0.01, 1e-4, 1e-6; order 2.0; {words}"
    torn = [replace(row, outcome=Outcome.TORN) for row in rows]
    assert cell_of(torn, method=f"toy {variant}", page=page) == f"torn; {words}"
    unbuilt = [replace(row, outcome=Outcome.UNSUPPORTED) for row in rows]
    assert cell_of(unbuilt, method=f"toy {variant}", page=page) == "unsupported"


def test_an_experiment_has_its_own_rows_their_sentences_and_what_was_observed():
    torn, sound = (Cell(DISC, Toy(name), 1, "failure") for name in ("torn", "sound"))
    rows = {
        torn: row_of("mujoco torn", outcome=Outcome.TORN, sentence="it tore", gap=1.7, step=0.1),
        sound: row_of("mujoco sound", sentence="", step=0.1),
    }
    first = Failure("First", "It should turn.", (torn,), lambda material: [Observation("by hand", "a way", "0.02 rad")])
    second = Failure("Second", "So should this.", (sound,), columns=("energy",))
    page = replace(PAGE, scenes=(DISC,), failures=(first, second))
    text = render_page(page, Material(rows), "the command")["base.md"]
    one, two = (text.split(f"### {name}")[1].split("\n## ")[0].split("\n### ")[0] for name in ("First", "Second"))
    for words in ("| mujoco torn | **torn** 1.7 m |", "| by hand | a way | 0.02 rad |"):
        assert (words in one, words in two) == (True, False)
    assert "| mujoco sound | 100 ms | 5.3e-3 |" in two
