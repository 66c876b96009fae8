"""`crosscheck check MODEL`: how wrong a user's own model is at its own settings, and which settings are enough."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.model.ending import BadInput, Broken
from reports.run.files import write_whole

if TYPE_CHECKING:
    from reports.check.request import CheckReport, CheckRequest, Refused

LONGEST = 1000.0  # s of motion
SUFFIX = ".svg"
WIDTH = 120  # columns at most
# The words of `switch_off` in engines/mujoco/reading and engines/pymunk/reading, which are not imported for a help.
SWITCHED_OFF = (
    "contact, limit or sleep, in pymunk damping too, in MuJoCo frictionloss, forcelimit, armature, fluid, actuation, "
    "spring, damper, gravity or equality"
)


class Missed(Broken):
    """The model's own settings miss the tolerance."""


def check(
    model: Annotated[str, typer.Argument(help="model.xml, model.urdf, script.py[:SPACE], or a folder of them.")] = "",
    duration: Annotated[float, typer.Option(help="How long the motion is that is judged [s].")] = 2.0,
    tolerance: Annotated[
        float | None,
        typer.Option(help="Largest error: of angles [rad], of places in lengths; status 1 if it is missed."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Try four settings only.")] = False,
    everything: Annotated[bool, typer.Option("--all", help="Print all that was read, measured and tried.")] = False,
    fix_to: Annotated[
        float | None, typer.Option("--fix-to", help="Look for documented settings until this error is met.")
    ] = None,
    apply: Annotated[
        Path | None, typer.Option("--apply", help="Write the model or script with the advised settings, and run it.")
    ] = None,
    html: Annotated[Path | None, typer.Option("--html", help="Write the report into this file.")] = None,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", help="Write it as Markdown, pictures beside it.")
    ] = None,
    junit: Annotated[Path | None, typer.Option("--junit", help="Write a test a model as JUnit XML.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print all numbers as JSON instead of the report.")] = False,
    as_schema: Annotated[bool, typer.Option("--schema", help="Print what --json prints, as a JSON Schema.")] = False,
    without: Annotated[
        list[str] | None,
        typer.Option("--without", help=f"Switch off {SWITCHED_OFF} (repeatable)."),
    ] = None,
    key: Annotated[str, typer.Option(help="The stored state to begin with, or none; the first unless given.")] = "",
    step: Annotated[float | None, typer.Option(help="Your step [s], instead of the model's own.")] = None,
    limit: Annotated[float, typer.Option(help="CPU seconds after which the check of a model is ended.")] = 120.0,
) -> None:
    """Check a model of your own against ideal joints: how wrong your settings are, why, and which are enough.

    Exit status 1 if a tolerance that was asked for is missed.
    """
    if as_schema:
        from reports.check.schema import schema

        return _say(json.dumps(schema(), indent=1))
    _refuse_bad(model, duration, tolerance, fix_to, step, limit, {"html": html, "markdown": markdown, "junit": junit})
    if tolerance is not None and fix_to is not None:
        raise BadInput("--tolerance and --fix-to both name an error; give one of them")
    from reports.check.request import CheckRequest

    wanted = tolerance if fix_to is None else fix_to
    common: dict[str, Any] = {"duration": duration, "tolerance": wanted, "without": tuple(without or ()), "key": key}
    common |= {"step": step, "quick": quick, "search": fix_to is not None}
    if Path(model).is_dir():
        for name, given in (("apply", apply), ("html", html), ("all", everything)):
            if given:
                raise BadInput(f"--{name} is for one model, and {model} is a folder; give one of its models")
        return _check_folder(Path(model), common, limit, markdown, junit, as_json)
    pictures = html is not None or markdown is not None
    target = "" if apply is None else str(apply)
    request = CheckRequest(model, os.getcwd(), pictures=pictures, apply=target, **common)
    answer = asked(request, limit)
    _write(answer, html, markdown, junit)
    _print(answer, as_json, everything)
    if answer.trouble:
        raise BadInput(answer.trouble)
    if not answer.fine:
        raise Missed(answer.verdict)


def _refuse_bad(
    model: str,
    duration: float,
    tolerance: float | None,
    fix_to: float | None,
    step: float | None,
    limit: float,
    files: dict[str, Path | None],
) -> None:
    """Raises BadInput before anything is run."""
    if not model:
        raise BadInput("no model was given; give model.xml, model.urdf, script.py or a folder of them")
    sizes = (("duration", duration, LONGEST), ("tolerance", tolerance, 1.0), ("fix-to", fix_to, 1.0))
    for name, value, most in (*sizes, ("limit", limit, 1e6)):
        if value is not None and not 0 < value <= most:
            raise BadInput(f"--{name} is {value:g}; it must be greater than zero and at most {most:g}")
    if step is not None and not 0 < step <= duration:
        raise BadInput(f"--step is {step:g}; it must be greater than zero and at most the duration, {duration:g}")
    for name, path in files.items():
        if path is not None and (not path.name or path.is_dir()):
            raise BadInput(f"--{name} is {str(path)!r}, which is a folder; give a file")


def asked(request: CheckRequest, limit: float) -> CheckReport:
    """The answer to a CheckRequest, from a supervised process, with progress on stderr. Raises BadInput in one line."""
    from reports.check.request import Refused

    for _, answer in _answers([request], limit, 1):
        if isinstance(answer, Refused):
            raise BadInput(answer.sentence)
        return answer
    raise BadInput(f"{request.word}: no answer came back")


def _answers(
    requests: list[CheckRequest], limit: float, workers: int
) -> Iterator[tuple[CheckRequest, CheckReport | Refused]]:
    """Each request with its answer, as they come."""
    from dataclasses import replace

    from reports.check.request import Refused, answered
    from reports.model.outcomes import Loss, Outcome
    from reports.run.files import temporary_folder
    from reports.run.supervisor import supervise

    with temporary_folder() as folder:
        notes = folder / "progress"
        tell = _Progress(notes)
        items = [replace(each, notes=str(notes)) for each in requests] if len(requests) == 1 else requests
        try:
            for item, result, _ in supervise(answered, items, limit, workers, watch=tell, wall=limit + 60):
                tell.clear()
                if isinstance(result, Loss):
                    ended = result.outcome == Outcome.TIMED_OUT
                    how = result.sentence if ended else f"its process was lost: {result.sentence}"
                    remedy = "; give a larger --limit if that was to be expected" if ended else ""
                    yield item, Refused(f"{item.word}: {how}{remedy}")
                else:
                    yield item, result
        finally:
            tell.clear()


def _check_folder(
    folder: Path, common: dict[str, Any], limit: float, markdown: Path | None, junit: Path | None, as_json: bool
) -> None:
    """Every model of a folder, in as many processes as there are processors; one table."""
    from reports.check import rendering
    from reports.check.folder import HEADER, junit_xml, models, rows
    from reports.check.request import CheckReport, CheckRequest
    from reports.check.telling import Section
    from reports.write.tables import markdown as table

    begin, paths = monotonic(), models(folder)
    if not paths:
        raise BadInput(f"{folder}: it holds no model; give a folder with MJCF, URDF or scripts that import pymunk")
    requests = [CheckRequest(str(path), os.getcwd(), **common) for path in paths]
    found = {}
    for request, answer in _answers(requests, limit, os.cpu_count() or 1):
        found[request] = answer
        print(f"{monotonic() - begin:5.1f} s  {len(found)} of {len(requests)}: {request.word}", file=sys.stderr)
    answers = [(request, found[request]) for request in requests]
    files = {junit: junit_xml(answers, monotonic() - begin)} if junit is not None else {}
    if markdown is not None:
        files[markdown] = f"# {folder}\n\n{table(HEADER, rows(answers), left=6)}\n"
    write_whole(files, "give another file")
    if as_json:
        told = [
            {"model": request.word, "refused": None, "found": answer.data}
            if isinstance(answer, CheckReport)
            else {"model": request.word, "refused": answer.sentence, "found": None}
            for request, answer in answers
        ]
        _say(json.dumps(told, indent=1, allow_nan=False))
    else:
        _say(rendering.plain([Section("", header=HEADER, rows=tuple(rows(answers)))]))
    missed = [request.word for request, answer in answers if isinstance(answer, CheckReport) and not answer.fine]
    if missed:
        raise Missed(f"{len(missed)} of {len(answers)} models miss {common['tolerance']:g}: {', '.join(missed)}")


class _Progress:
    """A line that is overwritten on a terminal; one line for each part of the work into a file or a pipe."""

    def __init__(self, notes: Path) -> None:
        self._notes, self._said, self._begin, self._wide = notes, "", monotonic(), 0

    def __call__(self, running: list[Any]) -> None:
        with suppress(OSError):
            words = self._notes.read_text(encoding="utf-8")
            own = words if sys.stderr.isatty() else words.split(",")[0]
            if own and own != self._said:
                self._said = own
                self._show(f"{monotonic() - self._begin:5.1f} s  {own}")

    def _show(self, line: str) -> None:
        if sys.stderr.isatty():
            print(f"\r{line.ljust(self._wide)}", end="", file=sys.stderr, flush=True)
            self._wide = len(line)
        else:
            print(line, file=sys.stderr, flush=True)

    def clear(self) -> None:
        if sys.stderr.isatty() and self._wide:
            print(f"\r{' ' * self._wide}\r", end="", file=sys.stderr, flush=True)
            self._wide = 0


def _write(answer: CheckReport, html: Path | None, markdown: Path | None, junit: Path | None) -> None:
    from reports.check import rendering

    name, files = f"{answer.data['name']} in {answer.data['engine']}", dict[Path, str]()
    if html is not None:
        files[html] = rendering.html(name, answer.sections)
    if markdown is not None:
        drawn = [section.picture for section in answer.sections if section.picture is not None]
        paths = {title: f"{markdown.stem}_{number}{SUFFIX}" for number, (title, _) in enumerate(drawn, start=1)}
        files |= {markdown.with_name(paths[title]): drawing for title, drawing in drawn}
        files[markdown] = rendering.markdown(name, answer.sections, paths)
    if junit is not None:
        from reports.check.folder import junit_xml

        files[junit] = junit_xml([(answer.request, answer)], 0.0)
    if files:
        write_whole(files, "give another file")


def _print(answer: CheckReport, as_json: bool, everything: bool) -> None:
    from reports.check import rendering

    if as_json:
        return _say(json.dumps(answer.data, indent=1, allow_nan=False))
    width = min(WIDTH, shutil.get_terminal_size((WIDTH, 24)).columns)
    if everything:
        return _say(rendering.plain(answer.sections, width))
    written = "" if answer.data["applied"] else "; to have these settings written: --apply FILE"
    return _say(f"{rendering.plain([answer.answer], width)}All that was read, measured and tried: --all{written}.")


def _say(text: str) -> None:
    from reports.cli.terminal import written

    with written():
        print(text)
