"""`crosscheck compare`: two versions or builds of an engine against each other; status 1 if the second is worse."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, REFERENCES, STORE, Folder
from reports.model.ending import BadInput, Broken

if TYPE_CHECKING:
    from collections.abc import Callable

    from engines import Engine
    from reports.cli.terminal import Terminal
    from reports.model.measure import Measurement
    from reports.versions.column import VersionColumn
    from reports.versions.comparison import Comparison

WIDTH = 150  # into a file or a pipe
LONGEST = 300  # letters of a reason
# A loop, rolling, a skate, a slide, a chain: one short scene of each kind of joint, with others that are driven.
SCENES = ("driven_four_bar", "free_four_bar", "free_slider_crank", "rolling_ellipse", "sleigh", "pendulum_2")


@dataclass(frozen=True)
class Side:
    """`label`: how it is called in tables; `kept`: whether its rows belong into the store: a build may change."""

    label: str
    engine: str
    place: Path
    kept: bool


def compare(
    first: Annotated[str, typer.Argument(metavar="A", help="NAME==VERSION, a wheel, or a folder that holds a build.")],
    second: Annotated[str, typer.Argument(metavar="B", help="The other one, which must not be worse.")],
    engine: Annotated[
        str | None, typer.Option("--engine", help=f"The engine under test: its name, or {REFERENCES}.")
    ] = None,
    variant: Annotated[list[str] | None, typer.Option("--variant", help="Only this variant (repeatable).")] = None,
    scenes: Annotated[
        list[str] | None, typer.Option("--scenes", help="Only these scenes (repeatable, or with commas).")
    ] = None,
    cost: Annotated[
        float | None, typer.Option("--cost", help="Status 1 too if a method takes this many times as much CPU time.")
    ] = None,
    results: Folder = FOLDER,
) -> None:
    """Tell what changed in error, order, outcome and cost from A to B; status 1 if an error became 3 times as large."""
    if cost is not None and not 0 < cost < math.inf:
        raise BadInput(f"--cost is {cost:g}; give a number above 0, such as 1.5")
    from engines.registry import OTHERS, VARIANTS
    from reports.cli.terminal import Terminal
    from reports.cli.versions import named_scenes
    from reports.model.ending import nearest
    from reports.run.files import temporary_folder
    from reports.versions.comparison import compared

    engines = (*VARIANTS, *OTHERS) if engine is None else _named(engine)
    sides = [_side(word, engine, engines) for word in (first, second)]
    if sides[0].engine != sides[1].engine:
        raise BadInput(f"{first} is of {sides[0].engine}, and {second} of {sides[1].engine}; give two of one engine")
    if sides[0].label == sides[1].label:
        named = zip("AB", sides, strict=True)
        sides = [replace(side, label=f"{letter}: {side.label}") for letter, side in named]
    own = [each for each in engines if engine is not None or each.name == sides[0].engine]
    for word in variant or ():
        if word not in {each.variant for each in own}:
            raise nearest("variant", word, dict.fromkeys(each.variant for each in own))
    own = [each for each in own if not variant or each.variant in variant]
    chosen = named_scenes(scenes or list(SCENES))
    console = Terminal(WIDTH)
    with kept() as check, temporary_folder() as folder:
        stores = [(results if side.kept else folder / str(index)) / STORE for index, side in enumerate(sides)]
        columns = [_column(side, engine, own, chosen, store, check) for side, store in zip(sides, stores, strict=True)]
    for side, column in zip(sides, columns, strict=True):
        if told := column.trouble or column.mark:
            console.say(f"{side.label}: {told}")
    if columns[0].trouble:
        raise BadInput(f"nothing can be compared with {sides[0].label}: {columns[0].trouble}")
    found = compared(columns[0].rows, columns[1].rows)
    _print(console, found, sides)
    if found.worse or found.grown:
        grown = f", and {len(found.grown)} errors over all scenes" if found.grown else ""
        told = f"{len(found.worse)} numbers or outcomes{grown}"
        raise Broken(f"{sides[1].label} is worse than {sides[0].label} in {told}")
    dear = {method: ratio for method, ratio in found.costs.items() if cost is not None and ratio > cost}
    if dear:
        told = ", ".join(f"{method} takes {ratio:.2f} times the CPU time" for method, ratio in dear.items())
        raise Broken(f"{sides[1].label} is dearer than {sides[0].label}: {told}, and --cost is {cost:g}")


def _named(word: str) -> tuple[Engine, ...]:
    """The engines of a name or of a reference. Raises BadInput."""
    from engines.loading import is_reference
    from engines.registry import OTHERS, VARIANTS, load
    from reports.cli.selection import choose_engines

    if not is_reference(word):
        return choose_engines(word, None, (*VARIANTS, *OTHERS))
    try:
        return load(word)
    except ValueError as error:
        raise BadInput(str(error)) from None


def _side(word: str, engine: str | None, engines: tuple[Engine, ...]) -> Side:
    """What a word means. Raises BadInput."""
    from reports.run.installed import built, distributions_in, installed
    from reports.versions.catalogue import distributions, engine_of
    from reports.versions.column import modules_in

    name, equals, version = word.partition("==")
    if equals:
        known = engine_of(engines, [name])
        if known is None and engine is None:
            names = ", ".join(dict.fromkeys(each.name for each in engines))
            raise BadInput(f"{word}: no engine needs {name!r}; there are {names}")
        places = distributions(engines, known) if known is not None else (name,)
        return Side(word, engine or known or name, installed(places, version), True)
    place = built(Path(word))
    versions = distributions_in(place)
    known = engine_of(engines, [*versions, *modules_in(place)])
    if known is None and engine is None:
        held = ", ".join([*versions, *modules_in(place)][:5]) or "no package"
        raise BadInput(f"{word} holds {held}, which no engine needs; name the engine with --engine")
    told = ", ".join(f"{each} {number}" for each, number in versions.items())
    # A wheel's name repeats what is in it, with forty letters of platforms.
    name = "wheel" if Path(word).suffix == ".whl" else Path(word).absolute().name
    return Side(f"{told} ({name})" if told else name, engine or known or "", place, False)


def _column(
    side: Side,
    reference: str | None,
    engines: list[Engine],
    scenes: tuple,
    store: Path,
    check: Callable[[], None],
) -> VersionColumn:
    from reports.cli.selection import QUICK_CELL
    from reports.model.cells import QUICK
    from reports.versions.column import VersionRequest, column, modules_in

    request = VersionRequest(
        scenes,
        reference or side.engine,
        modules_in(side.place),
        side.place,
        store.absolute(),
        variants=tuple(dict.fromkeys(each.variant for each in engines)),
        every=QUICK,
        most=10 * QUICK_CELL,
        folder=Path.cwd(),
    )
    return column(side.label, request, engines, lambda labels: check())


def _print(console: Terminal, found: Comparison, sides: list[Side]) -> None:
    """Worse lines first, then better ones, then orders, then one sentence."""
    from reports.cli.terminal import print_table
    from reports.gate.change import DEAR
    from reports.write.tables import number

    def cell(value: float | str) -> str:
        return number(value) if isinstance(value, float) else str(value)

    rows = [
        [
            d.after.scene,
            d.after.method,
            number(d.after.step),
            d.quantity,
            cell(d.told(d.before)),
            cell(d.told(d.after)),
            "WORSE" if d.worse else "better" if d.quantity != "outcome" or d.after.outcome == "finished" else "other",
        ]
        for d in sorted(found.differences, key=lambda each: not each.worse)
    ]
    header = ("scene", "method", "step [s]", "what", sides[0].label, sides[1].label, "verdict")
    if rows:
        print_table(console, f"From {sides[0].label} to {sides[1].label}", header, rows, 2)
        console.print()
    for side, rows in zip(sides, _ended(found), strict=True):
        for told, count in rows.items():
            console.say(f"{side.label}: {told}{f' ({count} cells)' if count > 1 else ''}")
    turned = [[t.scene, t.method, f"{t.before:.1f}", f"{t.after:.1f}"] for t in found.turns]
    if turned:
        print_table(console, "Order of the angle's error", ("scene", "method", "before", "after"), turned, 2)
        console.print()
    for check in found.grown:
        console.say(f"{sides[1].label}: {check}")
    for method, ratio in found.costs.items():
        if ratio > DEAR:
            console.say(f"{sides[1].label}: {method} takes {ratio:.3g} times the CPU time")
    better = len(found.differences) - len(found.worse)
    cost = "nothing was timed"
    if math.isfinite(found.cost):
        cost = f"CPU time is {found.cost:.2f} times as much, by the median"
    console.say(f"{found.pairs} cells in both: {len(found.worse)} numbers are worse, {better} better or other; {cost}")


def _ended(found: Comparison) -> tuple[Counter[str], Counter[str]]:
    """Of each side why cells ended as they did, where the other's did not, and how many for each reason."""
    from reports.model.outcomes import Outcome

    def told(row: Measurement) -> str:
        usable = Outcome(row.outcome).comparable
        return "" if usable else ": ".join(filter(None, (row.outcome, " ".join(row.sentence.split())[:LONGEST])))

    ended = [each for each in found.differences if each.quantity == "outcome"]
    before, after = (Counter(map(told, rows)) for rows in ([d.before for d in ended], [d.after for d in ended]))
    for counted in (before, after):
        del counted[""]
    return before, after
