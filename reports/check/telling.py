"""What a check says: sections of sentences and tables for a reader."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from reports.check.checked import MOST_NAMED, SATURATED, Checked, Parts, Tried, best
from reports.check.judging import UNITS
from reports.check.rendering import Section
from reports.write import tables

MOST_NOTES = 4  # of what is left out, on the first screen
CHEAPER = 0.9  # of the user's CPU time: what differs by less may be the clock's noise
BETTER = 0.9  # of an error: what takes less away is no setting of its own on the first screen
ROUNDING = 1e-12  # of a radian, and of the mechanism's length


def number(value: float) -> str:
    """Two digits, or a word."""
    return "gave up" if math.isinf(value) else tables.number(value)


def answer(found: Checked) -> Section:
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
        ("cost", f"{number(1e3 * found.own.stepping)} ms of CPU time for {found.duration:g} s in {model.engine}"),
        ("advice", " ".join(_advice(found))),
        ("written", _written(found)),
    ]
    lines = () if found.advised is None or found.met else found.advised.change.lines
    return Section("", (found.verdict,), tuple(pair for pair in facts if pair[1]), lines, HEADER, _front(found))


def sections(found: Checked, pictures: dict[str, tuple[str, str]] | None = None) -> tuple[Section, ...]:
    """The whole report, the answer first."""
    pictures = pictures or {}
    return (
        replace(answer(found), title="Answer"),
        _read(found),
        _own(found, pictures.get("errors")),
        replace(_table(found), picture=pictures.get("worst")),
    )


def line(found: Checked) -> tuple[str, ...]:
    """In a table of many models: how wrong, why, the advice, its error, and its CPU time in that of the user's."""
    own, advised = found.table[0], found.advised
    told = ("none that was tried", "-", "-")
    if advised is not None:
        told = (advised.change.words, number(advised.error), number(_ratio(advised, own)))
    return f"{number(own.error)}{' (missed)' if found.asked and not found.met else ''}", _cause(found.parts), *told


def _cause(parts: Parts) -> str:
    """Which part of the error is the largest."""
    if parts.step == 0 or math.isinf(parts.step):
        return "-" if parts.step == 0 else "gave up"
    if not parts.divided:
        return "step and softness"
    if not parts.falling and parts.rest > max(parts.softness, 0.5 * parts.step):
        return "neither softness nor step"
    return "softness" if parts.softness > parts.step else "step"


def _why(found: Checked) -> str:
    """Softness, step or neither, in a line."""
    parts, engine = found.parts, found.reading.model.engine
    if parts.rest > SATURATED:
        still = "the run still gives up" if math.isinf(parts.rest) else f"the error is still {number(parts.rest)}"
        return (
            f"not told: at {parts.smallest * 1e3:.3g} ms {still}, and what is off by "
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
    errors = found.own_errors
    sentences = []
    for name, start, end in (
        ("reaction", "reactions (forces and moments of the joints) are off by", "of the largest true one"),
        ("energy", "energy (kinetic, and of gravity and springs) by", "of the largest kinetic one"),
    ):
        if not math.isnan(worst := errors.worst[name]):
            # After a start that jumps, an engine takes some steps to make the impulse: a reader has to see that.
            when = f", at {errors.t[int(np.nanargmax(errors.of[name]))]:.3g} s" if found.reading.jumps else ""
            sentences.append(f"{start} {number(worst)} {end}{when}")
    return "; ".join(sentences)


def _sensitivity(found: Checked) -> str:
    """How fast neighbouring starts part, and what that says of the error."""
    judge = found.judge
    growth = judge.grown
    if found.facts.locked:
        return "nothing can move: the joints leave no freedom, and the error is how far they give way"
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
        f"s: until then your run is off by {number(found.error_until_horizon)}, and no step makes any engine right "
        "long after it"
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


def _advice(found: Checked) -> tuple[str, ...]:
    advised, whose = found.advised, "" if found.asked else f" (for an error of {number(found.tolerance)}; name yours)"
    if found.met and advised is not None and advised.cost >= CHEAPER * found.own.stepping:
        return (f"no setting that was tried meets it much cheaper{whose}.", *_decade(found))
    if advised is None:
        closest = min(found.table, key=lambda each: each.error)
        until = ""
        if found.chaotic:
            early = [each for each in found.table if found.until_horizon(each.errors) <= found.tolerance]
            enough = min(early, key=lambda each: each.cost, default=None)
            until = f" Until {found.judge.horizon:.3g} s, {enough.change.words} does." if enough else ""
        return (
            f"none of the {len(found.table)} documented settings that were tried meets {number(found.tolerance)}; the "
            f"best reached {number(closest.error)} ({closest.change.words}).{until}",
        )
    ratio = _ratio(advised, found.table[0])
    return (
        f"{advised.change.words}{whose}: the error is {number(advised.error)} instead of "
        f"{number(found.own_errors.largest)}, at {number(ratio)} times your CPU time.",
        *_decade(found),
    )


def _decade(found: Checked) -> tuple[str, ...]:
    advised, decade = found.advised, found.decade
    if advised is None or advised.error <= ROUNDING or decade is None:
        return ()
    return (f"A tenth of that error costs {number(_ratio(decade, advised))} times as much: {decade.change.words}.",)


def _ratio(one: Tried, other: Tried) -> float:
    """Of their CPU times."""
    return one.cost / other.cost if other.cost > 0 else float("nan")


def _written(found: Checked) -> str:
    written = found.applied
    if written is None:
        return ""
    reached = f"run from the file: off by {number(written.error)}, at {number(1e3 * written.cpu)} ms of CPU time"
    return "; ".join((f"{written.file}: {written.words}", reached, *written.notes))


HEADER = ("setting", "largest error", "reaction error", "CPU, ms", "")


def _front(found: Checked) -> tuple[tuple[str, ...], ...]:
    """The user's own settings, and those that none beats in both error and cost."""
    own = found.table[0]
    shown = [own]
    for each in best(found.table):
        if each is not own and not each.error > BETTER * shown[-1].error:
            shown.append(each)
    return tuple(_row(found, each, "yours" if each is own else "") for each in shown)


def _row(found: Checked, each: Tried, *marks: str) -> tuple[str, ...]:
    told = [*marks, "meets the tolerance" if each.error <= found.tolerance else ""]
    cells = number(each.error), number(each.reaction), number(1e3 * each.cost)
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
    for quantity, unit in UNITS.items():
        cells = [number(float(own.of[quantity][index])) for index in quarter]
        rows.append((f"{quantity}, {unit}", *cells, number(own.worst[quantity]), number(judge.worst[quantity])))
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
    alike: dict[tuple[str, str], list[Tried]] = {}
    for each in found.table:
        alike.setdefault((number(each.error), number(each.reaction)), []).append(each)

    def row(group: list[Tried]) -> tuple[str, ...]:
        shown = group[0] if group[0] is found.table[0] else min(group, key=lambda each: each.cost)
        same = f"{len(group) - 1} more alike" if len(group) > 1 else ""
        return _row(found, shown, "none is both cheaper and better" if shown.front else "", same)

    sentences = (
        "Your model with other settings that its engine documents; all else is as you have it. CPU time is of stepping "
        "alone, on this machine. Of settings with the same errors the cheapest is listed, or yours.",
    )
    return Section("What to change", sentences, header=HEADER, rows=tuple(row(group) for group in alike.values()))
