"""What a check says: sections of sentences and tables for a reader, and all numbers as plain data for programs."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

from reports.check.checked import Checked, Tried, cheapest
from reports.check.judging import QUANTITIES, UNITS
from reports.write import tables

MOST_NAMED = 6
MOST_NOTES = 4  # of what is left out, on the first screen
CHEAPER = 0.9  # of the user's CPU time: what differs by less may be the clock's noise
BETTER = 0.9  # of an error: what takes less away is no setting of its own on the first screen
SATURATED = 1.0  # rad, or lengths of the mechanism
ROUNDING = 1e-12  # of a radian, and of the mechanism's length


@dataclass(frozen=True)
class Section:
    """A part of the report. `facts`: what a sentence is about, and the sentence; `code`: lines to copy; `picture`: what
    it shows, and the SVG.
    """

    title: str
    sentences: tuple[str, ...] = ()
    facts: tuple[tuple[str, str], ...] = ()
    code: tuple[str, ...] = ()
    header: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    picture: tuple[str, str] | None = None


def number(value: float) -> str:
    """Two digits, or a word."""
    return "gave up" if math.isinf(value) else tables.number(value)


def verdict(found: Checked, asked: bool = True) -> str:
    """The answer in one sentence; `asked`: whether somebody named the tolerance."""
    assumed, engine = found.reading.model.assumed, found.reading.model.engine
    start = f"With {assumed}, {found.name}" if assumed else found.name
    tolerance = f"; the tolerance of {number(found.tolerance)} is {'met' if found.met else 'missed'}" if asked else ""
    if not found.own_errors.finished:
        return f"{start} in {engine} gives up before {found.duration:g} s{tolerance}."
    return f"{start} in {engine} is off by up to {number(found.own_errors.largest)} in {found.duration:g} s{tolerance}."


def answer(found: Checked, asked: bool = True) -> Section:
    """What fits on one screen: how wrong, why, where, what is taken for granted, what to do, and what it costs."""
    model = found.reading.model
    size = f"{found.facts.length:.3g} m, the length of the mechanism"
    facts = [
        ("measure", f"the largest error of all angles [rad] and all centres of mass [{size}], beside ideal joints"),
        ("why", _why(found)),
        ("joint", _opening(found)),
        ("motion", _sensitivity(found) + _cut(found)),
        ("forces", _forces(found)),
        ("assumed", _assumed(found)),
        ("cost", f"{number(1e3 * found.cost)} ms of CPU time for {found.duration:g} s in {model.engine}"),
        ("advice", " ".join(_advice(found, asked))),
    ]
    return Section(
        "", (verdict(found, asked),), tuple(pair for pair in facts if pair[1]), _lines(found), *_front(found)
    )


def sections(found: Checked, pictures: dict[str, tuple[str, str]] | None = None, asked: bool = True) -> list[Section]:
    """The whole report, the answer first."""
    pictures = pictures or {}
    return [
        replace(answer(found, asked), title="Answer"),
        _read(found),
        _own(found, pictures.get("errors")),
        replace(_table(found), picture=pictures.get("worst")),
    ]


def _why(found: Checked) -> str:
    """Softness, step or neither, in a line."""
    parts, engine = found.parts, found.reading.model.engine
    if parts.rest > SATURATED:
        return (
            f"not told: at {parts.smallest * 1e3:.3g} ms the error is still {number(parts.rest)}, and what is off by "
            "more than a radian or a length no longer tells softness from step; give a shorter --duration"
        )
    own = "gave up" if math.isinf(parts.step) else number(parts.step)
    step = f"the step of {found.reading.model.dt * 1e3:.4g} ms makes {own}"
    if not parts.divided:
        softness = f"how soft a joint is depends on the step in {engine}, so the two can't be told apart"
        if math.isnan(parts.rest):
            return f"{step}; {softness}"
        left = f"at {parts.smallest * 1e3:.3g} ms it is {number(parts.rest)}"
        return f"{step}; {left}, {'and still falls' if parts.falling else 'and no longer falls'}; {softness}"
    if found.reading.model.softly_held:
        softness = (
            f"joints as soft as {engine} declares them make {number(parts.softness)}, which only stiffer ones mend"
        )
    else:
        softness = "no softness (the joints are coordinates, which can't part)"
    if math.isnan(parts.rest):
        return f"{softness}; {step}"
    neither = (
        "no sign of a fault that is neither"
        if parts.falling
        else (f"{number(parts.rest)} is neither: it stays at {parts.smallest * 1e3:.3g} ms")
    )
    until = f" (until {found.judge.horizon:.3g} s)" if found.chaotic else ""
    return f"{softness}; {step}; {neither}{until}"


def _forces(found: Checked) -> str:
    reaction, energy = (found.own_errors.worst(name) for name in ("reaction", "energy"))
    told = (
        []
        if math.isnan(reaction)
        else [
            f"reactions (forces and moments of the joints' rows) are off by {number(reaction)} of the largest true one"
        ]
    )
    told += (
        []
        if math.isnan(energy)
        else [f"energy (kinetic, and of gravity and springs) by {number(energy)} of the largest kinetic one"]
    )
    return "; ".join(told)


def _sensitivity(found: Checked) -> str:
    """How fast neighbouring starts part, and what that says of the error."""
    judge, own = found.judge, found.own_errors
    growth = float(judge.growth[-1])
    if not judge.trajectory.twist.any():
        return "nothing moves: no force has a share in the plane of motion, and the start is at rest"
    if found.facts.freedoms[1] == 0:
        return "all of it is prescribed, so a small error of the start has nothing to grow in"
    if not found.chaotic:
        return (
            f"neighbouring starts are {number(growth)} times as far apart after {found.duration:g} s: not exponential"
        )
    return (
        f"neighbouring starts part exponentially from {judge.horizon:.3g} s on, tenfold every {number(judge.tenfold)} "
        f"s: until then your run is off by {number(found.until_horizon(own))}, and no step makes any engine right long "
        "after it"
    )


def _cut(found: Checked) -> str:
    known = f"; beyond {found.duration:.3g} s the judge itself does not know it to a tenth of the tolerance"
    return f"{known}, so nothing is compared there" if found.judge.cut else ""


def _assumed(found: Checked) -> str:
    model = found.reading.model
    step = model.assumed or f"a step of {model.dt * 1e3:.4g} ms, as in the model"
    left = [f"{note.element}: {note.reason}" for note in found.reading.notes]
    more = len(left) - MOST_NOTES
    return "; ".join([step, *left[:MOST_NOTES], *([f"{more} more (--all)"] if more > 0 else [])])


def _advice(found: Checked, asked: bool = True) -> tuple[str, ...]:
    advised, whose = found.advised, "" if asked else f" (for an error of {number(found.tolerance)}; name yours)"
    if found.met and advised is not None and advised.cost >= CHEAPER * found.cost:
        return (f"no setting that was tried meets it much cheaper{whose}.", *_decade(found))
    if advised is None:
        closest = min(found.table, key=lambda each: each.error)
        until = ""
        if found.chaotic:
            early = [replace(each, error=found.until_horizon(each.errors)) for each in found.table]
            enough = cheapest(early, found.tolerance)
            until = f" Until {found.judge.horizon:.3g} s, {enough.change.words} does." if enough else ""
        return (
            f"none of the {len(found.table)} documented settings that were tried meets {number(found.tolerance)}; the "
            f"best reached {number(closest.error)} ({closest.change.words}).{until}",
        )
    ratio = advised.cost / found.cost if found.cost > 0 else float("nan")
    return (
        f"{advised.change.words}{whose}: the error is {number(advised.error)} instead of "
        f"{number(found.own_errors.largest)}, at {number(ratio)} times your CPU time.",
        *_decade(found),
    )


def _decade(found: Checked) -> tuple[str, ...]:
    advised, decade = found.advised, found.decade
    if advised is None or advised.error == 0 or decade is None:
        return ()
    ratio = decade.cost / advised.cost if advised.cost > 0 else float("nan")
    return (f"A tenth of that error costs {number(ratio)} times as much: {decade.change.words}.",)


def _lines(found: Checked) -> tuple[str, ...]:
    return () if found.advised is None or found.met else found.advised.change.lines


HEADER = ("setting", "largest error", "reaction error", "CPU, ms", "")


def _front(found: Checked) -> tuple[tuple[str, ...], tuple[tuple[str, ...], ...]]:
    """(header, rows) of the user's own settings, and of those that none beats in both error and cost."""
    own = found.table[0]
    shown = [own]
    for each in found.fronts:
        if each is not own and not each.error > BETTER * shown[-1].error:
            shown.append(each)
    return HEADER, tuple(_row(found, each, "yours" if each is own else "") for each in shown)


def _row(found: Checked, each: Tried, *marks: str) -> tuple[str, ...]:
    told = [*marks, "meets the tolerance" if each.error <= found.tolerance else ""]
    cells = number(each.error), number(each.errors.worst("reaction")), number(1e3 * each.cost)
    return each.change.words, *cells, "; ".join(filter(None, told))


def _read(found: Checked) -> Section:
    facts, reading = found.facts, found.reading
    configuration, velocity = facts.freedoms
    sentences = [
        f"{found.name}: {facts.bodies} bodies, {facts.joints} joints ({facts.rows} rows), {facts.forces} force "
        f"elements; {velocity} freedom{'' if velocity == 1 else 's'} by the rank of the rows"
        + (f" ({configuration} of configuration)." if configuration != velocity else "."),
        f"At t = 0 the accelerations of {reading.model.engine} and of the judge agree to {found.agreement:.1g} of "
        "themselves" + (", with the softness that the engine declares." if reading.model.softly_held else "."),
    ]
    if facts.redundant:
        names = ", ".join(facts.undetermined[:MOST_NAMED])
        sentences.append(
            f"{facts.redundant} rows are redundant: rigid bodies alone don't tell the reactions of {names}"
            f"{' and others' if len(facts.undetermined) > MOST_NAMED else ''}, so these are not compared."
        )
    if facts.singular:
        t, size = min(facts.singular, key=lambda pair: pair[1])
        sentences.append(
            f"Near-singular positions on the way: {len(facts.singular)}, the nearest at {t:.3g} s, where the least "
            f"singular value of the rows is {size:.1g} of the largest."
        )
    else:
        sentences.append("No position on the way is near-singular.")
    if facts.dead_centres:
        told = "; ".join(f"{name} at {t:.3g} s" for t, name in facts.dead_centres[:MOST_NAMED])
        more = len(facts.dead_centres) - MOST_NAMED
        sentences.append(f"Dead centres, where a body turns back: {told}{f'; {more} more' if more > 0 else ''}.")
    fastest = max(facts.fastest_rotation, facts.stiffest_mode)
    sentences.append(
        f"Fastest rotation {facts.fastest_rotation:.3g} rad/s; stiffest small motion at the start "
        f"{facts.stiffest_mode:.3g} rad/s"
        + (
            f"; a radian of the fastest takes {1 / fastest:.2g} s, {1 / fastest / reading.model.dt:.2g} of your steps."
            if fastest > 0
            else "."
        )
    )
    for note in reading.notes:
        sentences.append(f"Note: {note.element}: {note.reason}.")
    rows = tuple((name, value) for name, value in reading.model.settings.items())
    return Section("What was read", tuple(sentences), header=("your setting", "value"), rows=rows)


def _own(found: Checked, picture: tuple[str, str] | None) -> Section:
    own, judge = found.own_errors, found.judge_errors
    quarter = [round(share * (len(own.t) - 1)) for share in (0.25, 0.5, 0.75, 1.0)]
    rows = []
    for quantity in QUANTITIES:
        cells = [number(float(own.of[quantity][index])) for index in quarter]
        label = f"{quantity}, {UNITS[quantity]}"
        rows.append((label, *cells, number(own.worst(quantity)), number(judge.worst(quantity))))
    header = ("error", *(f"at {own.t[index]:.3g} s" for index in quarter), "largest", "the judge's own")
    return Section("Your own settings", found.own.warnings, header=header, rows=tuple(rows), picture=picture)


def _opening(found: Checked) -> str:
    opens = found.opens
    if opens is None:
        return ""
    if opens.gap < ROUNDING * (found.facts.length if opens.unit == "m" else 1.0):
        return "none opens by more than rounding"
    return f"{opens.row} opens most: {number(opens.gap)} {opens.unit} at {opens.t:.3g} s"


def _table(found: Checked) -> Section:
    """Every setting that was tried; of those with the same errors the cheapest, or the user's."""
    front = {id(each) for each in found.fronts}
    alike: dict[tuple[str, str], list[Tried]] = {}
    for each in found.table:
        alike.setdefault((number(each.error), number(each.errors.worst("reaction"))), []).append(each)

    def row(group: list[Tried]) -> tuple[str, ...]:
        shown = group[0] if group[0] is found.table[0] else min(group, key=lambda each: each.cost)
        same = f"{len(group) - 1} more alike" if len(group) > 1 else ""
        return _row(found, shown, "none is both cheaper and better" if id(shown) in front else "", same)

    sentences = (
        "Your model with other settings that its engine documents; all else is as you have it. CPU time is of stepping "
        "alone, on this machine. Of settings with the same errors the cheapest is listed, or yours.",
    )
    return Section("What to change", sentences, header=HEADER, rows=tuple(row(group) for group in alike.values()))


def data(found: Checked, asked: bool = True, written: Any = None) -> dict[str, Any]:
    """All numbers of the report, for other programs: `reports.check.schema` says what each is."""

    def plain(value: Any) -> Any:
        if isinstance(value, float) and not math.isfinite(value):
            return None
        if isinstance(value, dict):
            return {key: plain(each) for key, each in value.items()}
        if isinstance(value, tuple | list):
            return [plain(each) for each in value]
        return value

    front = {id(each) for each in found.fronts}

    def setting(each: Tried | None) -> Any:
        if each is None:
            return None
        return {
            "words": each.change.words,
            "step": each.change.dt,
            "error": each.error,
            "reaction": each.errors.worst("reaction"),
            "cpu": each.cost,
            "lines": list(each.change.lines),
            "front": id(each) in front,
        }

    own, judge = found.own_errors, found.judge_errors
    return plain(
        {
            "name": found.name,
            "engine": found.reading.model.engine,
            "verdict": verdict(found, asked),
            "duration": found.duration,
            "tolerance": found.tolerance,
            "asked": asked,
            "met": found.met,
            "assumed": found.reading.model.assumed,
            "step": found.reading.model.dt,
            "error": own.largest,
            "cpu": found.cost,
            "facts": asdict(found.facts),
            "horizon": found.judge.horizon,
            "error_until_horizon": found.until_horizon(own),
            "growth": float(found.judge.growth[-1]),
            "tenfold": found.judge.tenfold,
            "cut": found.judge.cut,
            "agreement_at_start": found.agreement,
            "notes": [asdict(note) for note in found.reading.notes],
            "settings": dict(found.reading.model.settings),
            "errors": {quantity: own.worst(quantity) for quantity in QUANTITIES},
            "judge_errors": {quantity: judge.worst(quantity) for quantity in QUANTITIES},
            "over_time": {"t": own.t.tolist(), **{name: values.tolist() for name, values in own.of.items()}},
            "parts": asdict(found.parts),
            "opening": None if found.opens is None else asdict(found.opens),
            "warnings": list(found.own.warnings),
            "tried": [setting(each) for each in found.table],
            "advised": setting(found.advised),
            "next_decade": setting(found.decade),
            "applied": None if written is None else asdict(written),
        }
    )
