"""The pytest plugin with the options of `pytest -m crosscheck` and the table of verdicts.

The tests are in `reports.gate.grid_tests`. Only the cells of selected tests are run.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import pytest

from engines import Engine, method_name, registry
from engines.loading import is_reference
from reports.gate.change import WORSE, BadBaseline, Baseline, mixed, read_baseline
from reports.gate.theory import Case, count_vacuous
from reports.gate.walk import CaseVerdict, grown, remarks, run_and_check
from reports.model.ending import FileTrouble
from reports.run.files import write_whole
from reports.write.provenance import versions
from reports.write.tables import markdown, number, text_table
from reports.write.templates import environment

HEADER = ("scene", "method", "step [s]", "error", "bound", "nearest check", "how near", "verdict")


def lines(verdicts: Iterable[CaseVerdict]) -> list[list[str]]:
    """Rows of a table with the columns HEADER. Every case has a row."""
    out = []
    for verdict in verdicts:
        finest, worst = verdict.rows[-1], verdict.worst
        first = [finest.scene, finest.method, number(finest.step)]
        if worst is None:
            out.append([*first, "-", "-", "-", "-", "can't be built"])
            continue
        angles = [check for check in verdict.theory if check.quantity == "angle" and math.isfinite(check.bound)]
        angle = [number(angles[0].measured), number(angles[0].bound)] if angles else ["-", "-"]
        near = f"{worst.name} ({worst.quantity})" if worst.quantity != worst.name else worst.name
        gates = {"theory": verdict.theory_complaints, "change": verdict.change_complaints}
        failed = ", ".join(name for name, sentences in gates.items() if sentences)
        verdict_text = f"FAILED: {failed}" if failed else "known" if verdict.case.known else "passed"
        out.append([*first, *angle, near, number(worst.nearness), verdict_text])
    return out


def changes(verdicts: Iterable[CaseVerdict], baseline: Baseline) -> list[str]:
    """Sentences on other versions, changes, large CPU times and missing cells relative to the baseline."""
    verdicts = tuple(verdicts)
    out = [sentence] if (sentence := mixed(baseline)) else []
    out += [f"The baseline has no column {name!r}: this quantity is not compared." for name in baseline.unmeasured]
    if not baseline.same_versions:
        out.append(
            f"The baseline was made with {baseline.versions}; here are {versions()}. So errors may be up to "
            f"{WORSE:g} times as large, and a run that can be compared now and could not before is a remark."
        )
        for verdict in verdicts:
            for check in verdict.change:
                earlier = dict(check.terms).get("baseline", math.nan)
                if abs(check.measured - earlier) > 1e-3 * check.measured:
                    out.append(f"{verdict.case.label}: {check}")
        out += [str(check) for check in grown(verdicts, baseline) if not check.passed]
    out += [f"{verdict.case.label}: {sentence}." for verdict in verdicts for sentence in remarks(verdict)]
    new = sum(verdict.new for verdict in verdicts)
    if new:
        named = ", ".join(verdict.case.label for verdict in verdicts if verdict.new)
        reason = "a report leaves out fine steps where rounding is reached"
        out.append(f"{new} cells are not in the baseline ({reason}): {named}.")
    return out


def vacuous_checks(verdicts: Iterable[CaseVerdict]) -> list[str]:
    """Sentences with the number of theory checks that cannot fail, in total and by reason."""
    checks = [check for verdict in verdicts for check in verdict.theory]
    vacuous = count_vacuous(checks)
    out = [f"{len(checks)} checks of theory; {vacuous.total()} of them can't fail."]
    return out + [f"{count} can't fail: {reason}." for reason, count in vacuous.most_common()]


def report(verdicts: Iterable[CaseVerdict], baseline: Baseline) -> str:
    """The report as Markdown with a summary, failures, known deviations, and the table."""
    verdicts = tuple(verdicts)
    complaints = [(v, (*v.theory_complaints, *v.change_complaints)) for v in verdicts]
    deviating = [v for v, sentences in complaints if v.case.known and not sentences]
    known = [[v.case.scene.name, v.case.method, name, d.told, d.reason] for v in deviating for name, d in v.case.known]
    return (
        environment(Path(__file__).parent)
        .get_template("own/report.md")
        .render(
            count=len(verdicts),
            failed=[(v.case.label, sentences) for v, sentences in complaints if sentences],
            deviating=len(deviating),
            versions=versions(),
            known=markdown(["scene", "method", "check", "times its bound", "why"], known, left=5),
            vacuous=vacuous_checks(verdicts),
            changed=changes(verdicts, baseline),
            table=markdown(HEADER, lines(verdicts), left=2),
        )
    )


BASELINE = Path(__file__).parents[1] / "results" / "errors.csv"
VERDICTS = pytest.StashKey[dict[Case, CaseVerdict]]()
KNOWN = pytest.StashKey[Baseline]()
GIVEN = pytest.StashKey[tuple[Engine, ...]]()  # Engines that `--engine` names by a reference.
WANTED = pytest.StashKey[tuple[str, ...]]()  # Names of engines and methods that `--engine` selects.


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("crosscheck", "engines against the analytic truth")
    group.addoption("--scene", action="append", default=[], help="only this scene (repeatable)")
    group.addoption(
        "--engine",
        action="append",
        default=[],
        help='only this engine, or "engine variant"; or package.module:NAME, path/to/file.py[:NAME] (repeatable)',
    )
    group.addoption("--baseline", type=Path, default=BASELINE, help="errors.csv of an earlier run to compare with")
    group.addoption("--cost", type=float, help="how many times the baseline's CPU time a method may take, such as 1.5")
    group.addoption("--crosscheck-report", type=Path, metavar="FILE.md", help="write what was found as Markdown")


def pytest_configure(config: pytest.Config) -> None:
    """Read the baseline and check the options before any run. Raises UsageError."""
    if sentence := registry.mislabelled():
        raise pytest.UsageError(sentence)
    try:
        config.stash[KNOWN] = read_baseline(config.option.baseline)
    except BadBaseline as error:
        raise pytest.UsageError(str(error)) from None
    limit, target = config.getoption("--cost"), config.getoption("--crosscheck-report")
    if limit is not None and not 0 < limit < math.inf:
        raise pytest.UsageError(f"--cost {limit}: it must be a number above 0, such as 1.5")
    config.stash[GIVEN], config.stash[WANTED] = _engines(config.option.engine)
    if target is not None and not target.resolve().parent.is_dir():
        raise pytest.UsageError(f"--crosscheck-report {target}: there is no folder {target.parent}")
    if target is not None and target.is_dir():
        raise pytest.UsageError(f"--crosscheck-report {target}: it is a folder; give a file")


def _engines(words: Sequence[str]) -> tuple[tuple[Engine, ...], tuple[str, ...]]:
    loaded: dict[Engine, None] = {}
    wanted: list[str] = []
    by_method = {method_name(engine): engine for engine in registry.ENGINES}
    for argument in words:
        if not is_reference(argument):
            wanted.append(argument)
            continue
        try:
            engines = registry.load(argument)
        except ValueError as reason:
            raise pytest.UsageError(f"--engine {reason}") from None
        for engine in engines:
            method = method_name(engine)
            if by_method.setdefault(method, engine) != engine:
                raise pytest.UsageError(
                    f"--engine {argument}: another engine is called {method!r}; give it another name"
                )
            loaded[engine] = None
            wanted.append(method)
    return tuple(loaded), tuple(wanted)


def pytest_report_header() -> list[str]:
    """Lines about registered scenes, engines and pages that can't be used."""
    from reports.model.catalogue import TROUBLES

    return [f"crosscheck: {line}" for line in TROUBLES]


def case_of(item: pytest.Item) -> Case | None:
    """The case of a test, or None for a test without a case."""
    callspec = getattr(item, "callspec", None)
    value = callspec.params.get("case") if callspec is not None else None
    return value if isinstance(value, Case) else None


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Select the cases of --scene and --engine. Raises UsageError if no case is selected."""
    scenes, engines = config.option.scene, config.stash[WANTED]
    if not (scenes or engines):
        return
    selected = [item for item in items if _wanted(item, scenes, engines)]
    if not any(map(case_of, selected)):
        scene_names = sorted({case.scene.name for case in map(case_of, items) if case is not None})
        raise pytest.UsageError(
            f"no case of --scene {scenes} --engine {list(engines)}; scenes are {', '.join(scene_names)}"
        )
    config.hook.pytest_deselected(items=[item for item in items if item not in selected])
    items[:] = selected


def _wanted(item: pytest.Item, scenes: Sequence[str], engines: Sequence[str]) -> bool:
    case = case_of(item)
    if case is None:
        return "verdicts" in getattr(item, "fixturenames", ())
    return (not scenes or case.scene.name in scenes) and (
        not engines or case.engine.name in engines or case.method in engines
    )


@pytest.fixture(scope="session")
def verdicts(request: pytest.FixtureRequest) -> dict[Case, CaseVerdict]:
    """The verdicts on the selected cases. Only the cells of these cases are run. The runs use all processors. With
    `pytest -n` every worker would run the grid, so the tests are skipped."""
    if hasattr(request.config, "workerinput"):
        pytest.skip("the grid has workers of its own: pytest -m crosscheck, without -n")
    chosen = dict.fromkeys(case for case in map(case_of, request.session.items) if case is not None)
    by_case = run_and_check(chosen, request.config.stash[KNOWN], dearest=request.config.getoption("--cost"))
    request.config.stash[VERDICTS] = by_case
    return by_case


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    by_case = config.stash.get(VERDICTS, None)
    if not by_case:
        return
    baseline, verdicts = config.stash[KNOWN], by_case.values()
    terminalreporter.section("crosscheck")
    for line in (*text_table(HEADER, lines(verdicts)), *vacuous_checks(verdicts), *changes(verdicts, baseline)):
        terminalreporter.line(line)
    target = config.getoption("--crosscheck-report")
    if target is not None:
        try:
            write_whole({target: report(verdicts, baseline)}, "give another --crosscheck-report")
        except FileTrouble as reason:
            raise pytest.UsageError(str(reason)) from None
        terminalreporter.line(f"written to {target}")
