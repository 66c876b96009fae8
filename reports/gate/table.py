"""What a gate found, as tables: for the end of a run in a terminal, and as Markdown for a CI run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from reports.gate.baseline import Baseline, mixed
from reports.gate.theory import idle
from reports.gate.walk import Verdict, grown, remarks
from reports.write.provenance import versions
from reports.write.tables import markdown, number

HEADER = ("scene", "method", "step [s]", "error", "bound", "nearest check", "how near", "verdict")


def lines(verdicts: Iterable[Verdict]) -> list[list[str]]:
    """A line a case under HEADER: the angle's error and bound, and whatever came nearest to its own bound."""
    out = []
    for verdict in verdicts:
        finest, worst = verdict.rows[-1], verdict.worst
        if worst is None:
            out.append([finest.scene, finest.method, number(finest.step), "-", "-", "-", "-", "can't be built"])
            continue
        error = next((check for check in verdict.theory if check.name == "error" and math.isfinite(check.bound)), None)
        told = [number(error.measured), number(error.bound)] if error else ["-", "-"]
        near = f"{worst.name} ({worst.quantity})" if worst.quantity != worst.name else worst.name
        out.append(
            [
                finest.scene,
                finest.method,
                number(finest.step),
                *told,
                near,
                number(worst.nearness),
                verdict_word(verdict),
            ]
        )
    return out


def verdict_word(verdict: Verdict) -> str:
    """'passed', 'known' for one that misses what it is known to miss, or 'FAILED' with the gates that failed."""
    failed = [
        name for name, found in (("theory", verdict.theory_complaints), ("change", verdict.change_complaints)) if found
    ]
    if failed:
        return f"FAILED: {', '.join(failed)}"
    return "known" if verdict.case.known else "passed"


def plain(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A table as lines of text, columns aligned."""
    widths = [max(len(cell) for cell in column) for column in zip(header, *rows, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (header, *rows)
    ]


def changes(verdicts: Iterable[Verdict], baseline: Baseline) -> list[str]:
    """Sentences on the baseline: its versions if they differ, what changed then, what is dear, and cells it lacks."""
    verdicts = tuple(verdicts)
    out = [told] if (told := mixed(baseline)) else []
    if not baseline.same_versions:
        out.append(f"The baseline was made with {baseline.versions}; here are {versions()}.")
        for verdict in verdicts:
            found = [check for check in verdict.change if "baseline" in dict(check.terms)]
            other = [
                check for check in found if abs(check.measured - dict(check.terms)["baseline"]) > 1e-3 * check.measured
            ]
            out += [f"{verdict.case.label}: {check}" for check in other]
        out += [str(check) for check in grown(verdicts, baseline) if not check.passed]
    out += [f"{verdict.case.label}: {told}." for verdict in verdicts for told in remarks(verdict)]
    new = sum(verdict.new for verdict in verdicts)
    if new:
        named = ", ".join(verdict.case.label for verdict in verdicts if verdict.new)
        out.append(f"{new} cells are not in the baseline: {named}.")
    return out


def unable(verdicts: Iterable[Verdict]) -> list[str]:
    """Sentences on the checks of theory that can't fail: how many of how many, and for which reasons."""
    checks = [check for verdict in verdicts for check in verdict.theory]
    found = idle(checks)
    out = [f"{len(checks)} checks of theory; {found.total()} of them can't fail."]
    return out + [f"{count} can't fail: {reason}." for reason, count in found.most_common()]


def report(verdicts: Iterable[Verdict], baseline: Baseline) -> str:
    """The whole of it as Markdown: a summary, failures with their sentences, known deviations, and the table."""
    verdicts = tuple(verdicts)
    failed = [v for v in verdicts if v.theory_complaints or v.change_complaints]
    known = [v for v in verdicts if v.case.known and v not in failed]
    parts = [
        "# Crosscheck",
        f"{len(verdicts)} scenes and methods, {len(failed)} failed, {len(known)} with known deviations. {versions()}.",
    ]
    if failed:
        parts.append("## Failed")
        sentences = [f"{v.case.label}: {told}" for v in failed for told in (*v.theory_complaints, *v.change_complaints)]
        parts.append("\n".join(f"* {told}" for told in sentences))
    if known:
        parts.append("## Known deviations")
        body = [[v.case.scene.name, v.case.method, name, d.told, d.reason] for v in known for name, d in v.case.known]
        parts.append(markdown(["scene", "method", "check", "times its bound", "why"], body, left=5))
    parts += ["## Checks that can't fail", "\n".join(f"* {told}" for told in unable(verdicts))]
    changed = changes(verdicts, baseline)
    if changed:
        parts += ["## Baseline", "\n".join(f"* {told}" for told in changed)]
    parts += ["## All", markdown(HEADER, lines(verdicts), left=2)]
    return "\n\n".join(parts) + "\n"
