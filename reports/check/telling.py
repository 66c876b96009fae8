"""What a check says: sections of sentences and tables for a reader, and all numbers as plain data for programs."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from reports.check.checked import Checked, Tried
from reports.check.judging import QUANTITIES, UNITS

MOST_NAMED = 6
CHEAPER = 0.9  # of the user's CPU time: what differs by less may be the clock's noise
ROUNDING = 1e-12  # of a radian, and of the mechanism's length


@dataclass(frozen=True)
class Section:
    """A part of the report. `code`: lines to copy; `picture`: what it shows, and the SVG."""

    title: str
    sentences: tuple[str, ...] = ()
    header: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    code: tuple[str, ...] = ()
    picture: tuple[str, str] | None = None


def number(value: float) -> str:
    """Two digits, or a word."""
    if math.isnan(value):
        return "-"
    return "gave up" if math.isinf(value) else f"{value:.2g}"


def verdict(found: Checked) -> str:
    """The answer in one sentence."""
    assumed = found.reading.model.assumed
    whose = f"Assumed: {assumed}. With it, the settings" if assumed else "Your settings"
    start = f"{whose} {'meet' if found.met else 'miss'} the tolerance:"
    if not found.own_errors.finished:
        return f"{start} {found.reading.model.engine} gave up before {found.duration:g} s."
    return (
        f"{start} the largest error in {found.duration:g} s is {number(found.own_errors.largest)}, "
        f"{number(found.tolerance)} is allowed."
    )


def sections(found: Checked, pictures: dict[str, tuple[str, str]] | None = None) -> list[Section]:
    """The report, the answer first."""
    pictures = pictures or {}
    measure = (
        "Errors are the largest of all angles, in radians, and of all centres of mass, in lengths of the mechanism "
        f"({found.facts.length:.4g} m), against ideal joints."
    )
    return [
        Section("Answer", (verdict(found), measure, *_advice(found)), code=_lines(found)),
        _read(found),
        _own(found, pictures.get("errors")),
        Section("Where the error comes from", (*_parts(found), *_opening(found)), picture=pictures.get("worst")),
        _table(found),
    ]


def _advice(found: Checked) -> tuple[str, ...]:
    advised, own = found.advised, found.own_errors.largest
    if found.met and advised is not None and advised.cost >= CHEAPER * found.cost:
        return ("No setting that was tried meets it much cheaper.", *_decade(found))
    if advised is None:
        closest = min(found.table, key=lambda each: each.error)
        return (
            f"None of the {len(found.table)} documented settings that were tried meets it; the best reached "
            f"{number(closest.error)} ({closest.change.words}).",
        )
    ratio = advised.cost / found.cost if found.cost > 0 else float("nan")
    return (
        f"The cheapest documented setting that meets it: {advised.change.words}. Its error is "
        f"{number(advised.error)} instead of {number(own)}, at {ratio:.2g} times your CPU time.",
        *_decade(found),
    )


def _decade(found: Checked) -> tuple[str, ...]:
    advised, decade = found.advised, found.decade
    if advised is None or advised.error == 0:
        return ()
    if decade is None:
        return ("A tenth of that error was not reached by any setting that was tried.",)
    ratio = decade.cost / advised.cost if advised.cost > 0 else float("nan")
    return (f"A tenth of that error costs {ratio:.2g} times as much: {decade.change.words}.",)


def _lines(found: Checked) -> tuple[str, ...]:
    return () if found.advised is None or found.met else found.advised.change.lines


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
    if not found.judge.trajectory.twist.any():
        sentences.append("Nothing moves: no force has a share in the plane of motion, and the start is at rest.")
    sentences.append(
        f"Fastest rotation {facts.fastest_rotation:.3g} rad/s; stiffest small motion at the start "
        f"{facts.stiffest_mode:.3g} rad/s"
        + (
            f"; a radian of the fastest takes {1 / fastest:.2g} s, {1 / fastest / reading.model.dt:.2g} of your steps."
            if fastest > 0
            else "."
        )
    )
    growth = float(found.judge.growth[-1])
    if found.judge.horizon < found.duration:
        sentences.append(
            f"From about {found.judge.horizon:.3g} s on, small errors grow exponentially ({growth:.1g} times at the "
            "end): no step makes an engine's motion right long after that."
        )
    elif velocity == 0:
        sentences.append("The whole motion is prescribed, so a small error of the start has nothing to grow in.")
    else:
        sentences.append(f"Small errors grow {growth:.2g} times in {found.duration:g} s, which is not exponential.")
    if found.judge.cut:
        sentences.append(
            f"Beyond {found.duration:.3g} s the judge itself does not know the motion to a tenth of the tolerance: "
            "nothing is compared there."
        )
    for note in reading.notes:
        sentences.append(f"Note: {note.element}: {note.reason}.")
    rows = tuple((name, value) for name, value in reading.model.settings.items())
    return Section("What was read", tuple(sentences), ("your setting", "value"), rows)


def _own(found: Checked, picture: tuple[str, str] | None) -> Section:
    own, judge = found.own_errors, found.judge_errors
    quarter = [round(share * (len(own.t) - 1)) for share in (0.25, 0.5, 0.75, 1.0)]
    rows = []
    for quantity in QUANTITIES:
        cells = [number(float(own.of[quantity][index])) for index in quarter]
        label = f"{quantity}, {UNITS[quantity]}"
        rows.append((label, *cells, number(own.worst(quantity)), number(judge.worst(quantity))))
    header = ("error", *(f"at {own.t[index]:.3g} s" for index in quarter), "largest", "the judge's own")
    sentences = (
        f"{found.own.stepping:.2g} s of CPU time for {found.duration:g} s of motion.",
        "A reaction is the force or the moment of a row of a joint, beside the largest true one of its kind. Energy is "
        "the kinetic energy and the potentials of gravity and springs together, beside the largest true kinetic one.",
        *found.own.warnings,
    )
    return Section("Your own settings", sentences, header, tuple(rows), picture=picture)


def _parts(found: Checked) -> tuple[str, ...]:
    parts, model = found.parts, found.reading.model
    out = []
    if not parts.divided:
        smallest = (
            f"at a step of {parts.smallest * 1e3:.3g} ms, with all else as you have it, {number(parts.rest)} is left"
        )
        kind = (
            "it still falls: the step explains it" if parts.falling else "it no longer falls: a smaller step is no help"
        )
        return (
            f"Step: your run is off the ideal motion by {number(parts.step)}; {smallest}, and {kind}.",
            f"Softness: {model.engine} declares no law for all of these joints that no step takes part in, so its "
            "share is not told apart.",
        )
    if model.softly_held:
        out.append(
            f"Softness: the motion that {model.engine} declares for these joints is off the ideal one by "
            f"{number(parts.softness)}. No smaller step removes this; stiffer joints do."
        )
    else:
        out.append("Softness: none. The joints are coordinates here, which can't part.")
    if math.isfinite(parts.step):
        motion = "that declared motion" if model.softly_held else "the ideal motion"
        out.append(f"Step: your run is off {motion} by {number(parts.step)}.")
    else:
        out.append("Step: your run gave up, so its part has no number.")
    if math.isfinite(parts.rest):
        smallest = (
            f"at a step of {parts.smallest * 1e3:.3g} ms, with all else as you have it, {number(parts.rest)} is left"
        )
        if parts.falling:
            out.append(f"Neither: {smallest}, and it still falls: there is no sign of a third part.")
        else:
            out.append(f"Neither: {smallest}, and it no longer falls: this much neither softness nor step explains.")
    return tuple(out)


def _opening(found: Checked) -> tuple[str, ...]:
    opens = found.opens
    if opens is None:
        return ()
    if opens.gap < ROUNDING * (found.facts.length if opens.unit == "m" else 1.0):
        return ("No joint opens by more than rounding.",)
    return (f"The joint that opens most is {opens.row}: {number(opens.gap)} {opens.unit} at {opens.t:.3g} s.",)


def _table(found: Checked) -> Section:
    front = {id(each) for each in found.fronts}
    alike: dict[tuple[str, str, bool], list[Tried]] = {}
    for each in found.table:
        told = number(each.error), number(each.errors.worst("reaction")), each.error <= found.tolerance
        alike.setdefault(told, []).append(each)

    def row(told: tuple[str, str, bool], group: list[Tried]) -> tuple[str, ...]:
        shown = group[0] if group[0] is found.table[0] else min(group, key=lambda each: each.cost)
        marks = ["none is both cheaper and better"] if id(shown) in front else []
        marks += ["meets the tolerance"] if told[2] else []
        marks += [f"{len(group) - 1} more alike"] if len(group) > 1 else []
        return shown.change.words, told[0], told[1], number(shown.cost), "; ".join(marks)

    header = ("setting", "largest error", "reaction error", "CPU time, s", "")
    sentences = (
        "Your model with other settings that its engine documents; all else is as you have it. CPU time is of stepping "
        "alone, on this machine. Of settings with the same errors the cheapest is listed, or yours.",
    )
    return Section("What to change", sentences, header, tuple(row(*each) for each in alike.items()))


def data(found: Checked) -> dict[str, Any]:
    """All numbers of the report, for other programs."""

    def plain(value: Any) -> Any:
        if isinstance(value, float) and not math.isfinite(value):
            return None
        if isinstance(value, dict):
            return {key: plain(each) for key, each in value.items()}
        if isinstance(value, tuple | list):
            return [plain(each) for each in value]
        return value

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
        }

    own, judge = found.own_errors, found.judge_errors
    return plain(
        {
            "name": found.name,
            "engine": found.reading.model.engine,
            "duration": found.duration,
            "tolerance": found.tolerance,
            "met": found.met,
            "assumed": found.reading.model.assumed,
            "error": own.largest,
            "cpu": found.cost,
            "facts": asdict(found.facts),
            "horizon": found.judge.horizon,
            "growth": float(found.judge.growth[-1]),
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
        }
    )
