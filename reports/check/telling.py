"""The sections of a check's report: sentences and tables."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np

from reports.check.checked import NAMES_LISTED, CheckResult, ErrorParts
from reports.check.judging import ERROR_UNITS
from reports.check.rendering import Section
from reports.check.settings import SATURATED_ERROR, SettingRun, pareto_front
from reports.write import tables

NOTES_LISTED = 4  # Largest number of notes on elements in the short report.
CHEAPER_COST = 0.9  # A CPU time above this share of the user's CPU time may differ only by noise of the clock.
BETTER_ERROR = 0.9  # The first screen leaves out a setting whose error exceeds this share of the previous row's error.
CUT_NOTE = (
    "; beyond {:.3g} s the judge itself does not know it to a tenth of the tolerance, so nothing is compared there"
)
ROUNDING_ERROR = 1e-12  # Smaller errors [rad, or lengths of the mechanism] are rounding.
SETTINGS_HEADER = ("setting", "largest error", "reaction error", "CPU, ms", "")
number = partial(tables.number, infinite="gave up")


def answer_section(result: CheckResult) -> Section:
    size = f"{result.facts.length:.3g} m, the length of the mechanism"
    cost = f"{number(1e3 * result.own_cost)} ms of CPU time for {result.duration:g} s"
    facts = (
        ("measure", f"the largest error of all angles [rad] and all centres of mass [{size}], beside ideal joints"),
        ("why", _why(result)),
        ("joint", _opening(result)),
        ("motion", _sensitivity(result) + (CUT_NOTE.format(result.duration) if result.judge.cut else "")),
        ("forces", _forces(result)),
        ("assumed", _assumed(result)),
        ("cost", f"{cost} in {result.reading.model.engine}"),
        ("advice", " ".join(_advice(result))),
        ("written", _written(result)),
    )
    lines = () if result.advised is None or result.met else result.advised.change.lines
    return Section(
        "", (result.verdict,), tuple(pair for pair in facts if pair[1]), lines, SETTINGS_HEADER, _front(result)
    )


def report_sections(result: CheckResult, pictures: dict[str, tuple[str, str]] | None = None) -> tuple[Section, ...]:
    pictures = pictures or {}
    return (
        replace(answer_section(result), title="Answer"),
        _read(result),
        _own(result, pictures.get("errors")),
        replace(_table(result), picture=pictures.get("worst")),
    )


def summary_row(result: CheckResult) -> tuple[str, ...]:
    user, advised = result.table[0], result.advised
    advice = ("none that was tried", "-", "-")
    if advised is not None:
        advice = (advised.change.words, number(advised.error), number(_cost_ratio(advised, user)))
    missed = " (missed)" if result.has_tolerance and not result.met else ""
    return f"{number(user.error)}{missed}", _cause(result.parts), *advice


def _cause(parts: ErrorParts) -> str:
    if parts.step == 0 or math.isinf(parts.step):
        return "-" if parts.step == 0 else "gave up"
    if not parts.divided:
        return "step and softness"
    if not parts.falling and parts.rest > max(parts.softness, 0.5 * parts.step):
        return "neither softness nor step"
    return "softness" if parts.softness > parts.step else "step"


def _why(result: CheckResult) -> str:
    parts, model = result.parts, result.reading.model
    at_smallest, rest = f"at {parts.smallest * 1e3:.3g} ms", number(parts.rest)
    if parts.rest > SATURATED_ERROR:
        outcome = "the run still gives up" if math.isinf(parts.rest) else f"the error is still {rest}"
        return (
            f"not told: {at_smallest} {outcome}, and what is off by more than a radian or a length no longer tells "
            "softness from step; give a shorter --duration"
        )
    sentences = [f"the step of {model.dt * 1e3:.4g} ms makes {number(parts.step)}"]
    if not parts.divided:
        if not math.isnan(parts.rest):
            sentences.append(
                f"{at_smallest} it is {rest}, {'and still falls' if parts.falling else 'and no longer falls'}"
            )
        sentences.append(f"how soft a joint is depends on the step in {model.engine}, so the two can't be told apart")
        return "; ".join(sentences)
    softness = "no softness (the joints are coordinates, which can't part)"
    if model.has_soft_joints:
        softness = f"joints as soft as {model.engine} declares them make {number(parts.softness)}"
        softness += ", which only stiffer ones mend"
    sentences.insert(0, softness)
    if not math.isnan(parts.rest):
        neither = (
            "no sign of a fault that is neither" if parts.falling else f"{rest} is neither: it stays {at_smallest}"
        )
        sentences.append(neither + (f" (until {result.judge.horizon:.3g} s)" if result.chaotic else ""))
    return "; ".join(sentences)


def _forces(result: CheckResult) -> str:
    errors, sentences = result.own_errors, []
    for name, start, end in (
        ("reaction", "reactions (forces and moments of the joints) are off by", "of the largest true one"),
        ("energy", "energy (kinetic, and of gravity and springs) by", "of the largest kinetic one"),
    ):
        if not math.isnan(worst := errors.worst[name]):
            # An engine needs some steps for an initial impulse. So the time of the largest error is printed too.
            when = f", at {errors.t[int(np.nanargmax(errors.of[name]))]:.3g} s" if result.reading.jumps else ""
            sentences.append(f"{start} {number(worst)} {end}{when}")
    return "; ".join(sentences)


def _sensitivity(result: CheckResult) -> str:
    judge = result.judge
    if result.facts.locked:
        return "nothing can move: the joints leave no freedom, and the error is how far they give way"
    if not judge.trajectory.twist.any():
        return "nothing moves: no force has a share in the plane of motion, and the start is at rest"
    if result.facts.freedoms[1] == 0:
        return "all of it is prescribed, so a small error of the start has nothing to grow in"
    if not result.chaotic:
        times = f"{number(judge.grown)} times as far apart after {result.duration:g} s"
        return f"neighbouring starts are {times}: not exponential"
    return (
        f"neighbouring starts part exponentially from {judge.horizon:.3g} s on, tenfold every {number(judge.tenfold)} "
        f"s: until then your run is off by {number(result.error_until_horizon)}, and no step makes any engine right "
        "long after it"
    )


def _assumed(result: CheckResult) -> str:
    model = result.reading.model
    step = model.assumed or f"a step of {model.dt * 1e3:.4g} ms, as in the model"
    notes = [f"{note.element}: {note.reason}" for note in result.reading.notes]
    extra = [f"{len(notes) - NOTES_LISTED} more (--all)"] if len(notes) > NOTES_LISTED else []
    return "; ".join([step, *notes[:NOTES_LISTED], *extra])


def _advice(result: CheckResult) -> tuple[str, ...]:
    advised = result.advised
    goal = "" if result.has_tolerance else f" (for an error of {number(result.tolerance)}; name yours)"
    if advised is None:
        closest = min(result.table, key=lambda setting: setting.error)
        early = [setting for setting in result.table if result.until_horizon(setting.errors) <= result.tolerance]
        enough = min(early, key=lambda setting: setting.cost, default=None) if result.chaotic else None
        until = f" Until {result.judge.horizon:.3g} s, {enough.change.words} does." if enough else ""
        return (
            f"none of the {len(result.table)} documented settings that were tried meets {number(result.tolerance)}; "
            f"the best reached {number(closest.error)} ({closest.change.words}).{until}",
        )
    tenth = ()
    if advised.error > ROUNDING_ERROR and result.decade is not None:
        ratio = number(_cost_ratio(result.decade, advised))
        tenth = (f"A tenth of that error costs {ratio} times as much: {result.decade.change.words}.",)
    if result.met and advised.cost >= CHEAPER_COST * result.own_cost:
        return (f"no setting that was tried meets it much cheaper{goal}.", *tenth)
    errors = f"the error is {number(advised.error)} instead of {number(result.own_errors.largest)}"
    ratio = number(_cost_ratio(advised, result.table[0]))
    return (f"{advised.change.words}{goal}: {errors}, at {ratio} times your CPU time.", *tenth)


def _cost_ratio(setting: SettingRun, other: SettingRun) -> float:
    return setting.cost / other.cost if other.cost > 0 else float("nan")


def _written(result: CheckResult) -> str:
    written = result.applied
    if written is None:
        return ""
    reached = f"run from the file: off by {number(written.error)}, at {number(1e3 * written.cpu)} ms of CPU time"
    return "; ".join((f"{written.file}: {written.words}", reached, *written.notes))


def _front(result: CheckResult) -> tuple[tuple[str, ...], ...]:
    rows_shown = [result.table[0]]
    for setting in pareto_front(result.table):
        if setting is not result.table[0] and not setting.error > BETTER_ERROR * rows_shown[-1].error:
            rows_shown.append(setting)
    return tuple(_row(result, setting, "" if index else "yours") for index, setting in enumerate(rows_shown))


def _row(result: CheckResult, setting: SettingRun, *marks: str) -> tuple[str, ...]:
    remarks = [*marks, "meets the tolerance" if setting.error <= result.tolerance else ""]
    cells = number(setting.error), number(setting.reaction), number(1e3 * setting.cost)
    return setting.change.words, *cells, "; ".join(filter(None, remarks))


def _read(result: CheckResult) -> Section:
    facts, reading = result.facts, result.reading
    model, (configuration, velocity) = reading.model, facts.freedoms
    sentences = [
        f"{result.name}: {facts.bodies} bodies, {facts.joints} joints ({facts.rows} rows), {facts.forces} force "
        f"elements; {velocity} freedom{'' if velocity == 1 else 's'} by the rank of the rows"
        + (f" ({configuration} of configuration)." if configuration != velocity else "."),
        f"At t = 0 the accelerations of {model.engine} and of the judge agree to {result.agreement:.1g} of themselves"
        + (", with the softness that the engine declares." if model.has_soft_joints else "."),
    ]
    if facts.redundant:
        names = ", ".join(facts.undetermined[:NAMES_LISTED])
        others = " and others" if len(facts.undetermined) > NAMES_LISTED else ""
        sentences.append(
            f"{facts.redundant} rows are redundant: rigid bodies alone don't tell the reactions of {names}{others}, so "
            "these are not compared."
        )
    t, size = min(facts.singular, key=lambda pair: pair[1], default=(0.0, 0.0))
    sentences.append(
        f"Near-singular positions on the way: {len(facts.singular)}, the nearest at {t:.3g} s, where the least "
        f"singular value of the rows is {size:.1g} of the largest."
        if facts.singular
        else "No position on the way is near-singular."
    )
    if facts.dead_centres:
        centres = "; ".join(f"{name} at {t:.3g} s" for t, name in facts.dead_centres[:NAMES_LISTED])
        extra = len(facts.dead_centres) - NAMES_LISTED
        sentences.append(f"Dead centres, where a body turns back: {centres}{f'; {extra} more' if extra > 0 else ''}.")
    fastest = max(facts.fastest_rotation, facts.stiffest_mode)
    takes = 1 / fastest if fastest > 0 else 0.0
    radian = f"; a radian of the fastest takes {takes:.2g} s, {takes / model.dt:.2g} of your steps"
    sentences += [
        f"Fastest rotation {facts.fastest_rotation:.3g} rad/s; stiffest small motion at the start "
        f"{facts.stiffest_mode:.3g} rad/s{radian if fastest > 0 else ''}.",
        *(f"Note: {note.element}: {note.reason}." for note in reading.notes),
    ]
    return Section("What was read", tuple(sentences), header=("your setting", "value"), rows=(*model.settings.items(),))


def _own(result: CheckResult, picture: tuple[str, str] | None) -> Section:
    errors, judge = result.own_errors, result.judge_errors
    quarters = [round(share * (len(errors.t) - 1)) for share in (0.25, 0.5, 0.75, 1.0)]
    rows = tuple(
        (
            f"{quantity}, {unit}",
            *(number(float(errors.of[quantity][index])) for index in quarters),
            number(errors.worst[quantity]),
            number(judge.worst[quantity]),
        )
        for quantity, unit in ERROR_UNITS.items()
    )
    header = ("error", *(f"at {errors.t[index]:.3g} s" for index in quarters), "largest", "the judge's own")
    return Section("Your own settings", result.own.warnings, header=header, rows=rows, picture=picture)


def _opening(result: CheckResult) -> str:
    opens = result.opens
    if opens is None:
        return ""
    if opens.gap < ROUNDING_ERROR * (result.facts.length if opens.unit == "m" else 1.0):
        return "none opens by more than rounding"
    return f"{opens.row} opens most: {number(opens.gap)} {opens.unit} at {opens.t:.3g} s"


def _table(result: CheckResult) -> Section:
    groups: dict[tuple[str, str], list[SettingRun]] = {}
    for setting in result.table:
        groups.setdefault((number(setting.error), number(setting.reaction)), []).append(setting)

    def row(group: list[SettingRun]) -> tuple[str, ...]:
        displayed = group[0] if group[0] is result.table[0] else min(group, key=lambda setting: setting.cost)
        same = f"{len(group) - 1} more alike" if len(group) > 1 else ""
        return _row(result, displayed, "none is both cheaper and better" if displayed.front else "", same)

    sentences = (
        "Your model with other settings that its engine documents; all else is as you have it. CPU time is the number "
        "of steps times the least time of a step with these options, on this machine. Of settings with the same errors "
        "the cheapest is listed, or yours.",
    )
    return Section(
        "What to change", sentences, header=SETTINGS_HEADER, rows=tuple(row(group) for group in groups.values())
    )
