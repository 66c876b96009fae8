"""`crosscheck compare`: two versions or builds of an engine against each other; status 1 if the second is worse."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.interruption import kept
from reports.cli.options import FOLDER, REFERENCES, STORE, AsJson, AsMarkdown, Folder
from reports.cli.versions import SCENES, USUAL, named_scenes, request_of, run_column, tell_of_pip
from reports.model.ending import BadInput, Broken

if TYPE_CHECKING:
    from engines import Engine
    from reports.cli.terminal import Terminal
    from reports.model.measure import Measurement
    from reports.versions.comparison import Comparison, Difference

WIDTH = 150  # into a file or a pipe
LONGEST = 300  # letters of a reason


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
    scenes: Annotated[list[str] | None, typer.Option("--scenes", help=USUAL)] = None,
    cost: Annotated[
        float | None, typer.Option("--cost", help="Status 1 too if a method takes this many times as much CPU time.")
    ] = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Tell what changed in error, order, outcome and cost from A to B; status 1 if an error became 3 times as large."""
    if cost is not None and not 0 < cost < math.inf:
        raise BadInput(f"--cost is {cost:g}; give a number above 0, such as 1.5")
    from engines.registry import OTHERS, VARIANTS
    from reports.cli.selection import QUICK_CELL
    from reports.cli.terminal import telling
    from reports.model.cells import QUICK
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
    with telling(WIDTH, as_json, as_markdown) as console:
        with kept() as check, temporary_folder() as folder:
            stores = [(results if side.kept else folder / str(index)) / STORE for index, side in enumerate(sides)]
            asked = {"every": QUICK, "most": 10 * QUICK_CELL, "variants": tuple(dict.fromkeys(e.variant for e in own))}
            columns = []
            for side, store in zip(sides, stores, strict=True):
                request = request_of(engine or side.engine, side.place, chosen, store, **asked)
                columns.append(run_column(console, side.label, side.label, request, own, check))
        for side, column in zip(sides, columns, strict=True):
            if told := column.trouble or column.mark:
                console.tell(f"{side.label}: {told}")
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
        tell_of_pip(word)
        return Side(word, engine or known or name, installed(places, version), True)
    if Path(word).exists():
        tell_of_pip(word)
    place = built(Path(word))
    versions = distributions_in(place)
    known = engine_of(engines, [*versions, *modules_in(place)])
    if known is None and engine is None:
        held = ", ".join([*versions, *modules_in(place)][:5])
        if not held:
            raise BadInput(f"{word} holds no package; give NAME==VERSION, a wheel or a folder with one")
        raise BadInput(f"{word} holds {held}, which no engine needs; name the engine with --engine")
    told = ", ".join(f"{each} {number}" for each, number in versions.items())
    # A wheel's name repeats what is in it, with forty letters of platforms.
    name = "wheel" if Path(word).suffix == ".whl" else Path(word).absolute().name
    return Side(f"{told} ({name})" if told else name, engine or known or "", place, False)


def _print(console: Terminal, found: Comparison, sides: list[Side]) -> None:
    """A line for each method of each scene, what became worse in full, then orders, cost, and one sentence."""
    from reports.cli.terminal import print_table
    from reports.gate.change import DEAR

    first, second = (side.label for side in sides)
    lines = found.lines()
    rows = [
        [line.scene, line.method, *_told(line.chief), line.cost, line.verdict]
        for line in sorted(lines, key=lambda line: (line.scene, line.method))
    ]
    header = ("scene", "method", "what changed most", "step [s]", first, second, "CPU time, times", "verdict")
    if rows:
        print_table(console, f"From {first} to {second}", header, rows, 3)
        console.print()
    other = tuple(each for each in found.differences if not each.worse)
    asked = (("worse", found.worse), ("better, or other", other if console.form == "json" else ()))
    for word, differences in asked:
        if differences:
            every = [[each.after.scene, each.after.method, *_told(each)] for each in differences]
            header = ("scene", "method", "what", "step [s]", first, second)
            print_table(console, f"Numbers and outcomes that are {word}", header, every, 3)
            console.print()
    for side, rows in zip(sides, _ended(found), strict=True):
        for told, count in rows.items():
            console.tell(f"{side.label}: {told}{f' ({count} cells)' if count > 1 else ''}")
    turned = [[t.scene, t.method, t.before, t.after] for t in found.turns]
    if turned:
        print_table(console, "Order of the angle's error", ("scene", "method", first, second), turned, 2)
        console.print()
    for check in found.grown:
        console.tell(f"{second}: {check}")
    for method, ratio in found.costs.items():
        if ratio > DEAR:
            console.tell(f"{second}: {method} takes {ratio:.3g} times the CPU time")
    cost = "nothing was timed"
    if math.isfinite(found.cost):
        cost = f"CPU time is {found.cost:.2f} times as much, by the median"
    still = sum(line.verdict == "nothing changed" for line in lines)
    console.tell(
        f"From {first} to {second}, {len(found.pairs)} cells of both: {len(found.worse)} numbers are worse, "
        f"{len(other)} better or other; nothing changed in {still} of {len(lines)} methods of scenes; {cost}"
    )


def _told(difference: Difference) -> list[str | float]:
    """What, in its unit, at which step, before and after."""
    from reports.model.quantities import quantity

    name = difference.quantity
    what = name if name == "outcome" else f"{name} [{quantity(name).unit}]"
    return [what, difference.after.step, difference.told(difference.before), difference.told(difference.after)]


def _ended(found: Comparison) -> tuple[Counter[str], Counter[str]]:
    """Of each side why cells ended as they did, where the other's did not, and how many for each reason."""
    from reports.model.outcomes import Outcome

    def told(row: Measurement) -> str:
        usable = Outcome(row.outcome).comparable
        # Of the engine's words alone: what our adapter adds to them is the same in other words.
        sentence = " ".join(row.sentence.partition("; ours: ")[0].split())[:LONGEST]
        return "" if usable else ": ".join(filter(None, (row.outcome, sentence)))

    ended = [each for each in found.differences if each.quantity == "outcome"]
    before, after = (Counter(map(told, rows)) for rows in ([d.before for d in ended], [d.after for d in ended]))
    for counted in (before, after):
        del counted[""]
    return before, after
