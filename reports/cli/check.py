"""`crosscheck check MODEL`: how wrong a user's own model is at its own settings, and which settings are enough."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.cli.options import STDOUT, refuse_existing
from reports.model.ending import BadInput, Broken, visible

if TYPE_CHECKING:
    from reports.check.folder import Answers
    from reports.check.request import CheckReport, CheckRequest, Refused

WIDTH = 120  # columns at most
OVERWRITE = "\r\x1b[K"  # on a terminal
# What a check imports: the process from which workers are forked does so while this one gets ready.
EARLY = ("reports.check.applying", "reports.check.document", "reports.check.telling", "numba")
# The words of `switch_off` in engines/mujoco/reading and engines/pymunk/reading, which are not imported for a help.
SWITCHED_OFF = (
    "contact, limit or sleep, in pymunk damping too, in MuJoCo frictionloss, forcelimit, armature, fluid, actuation, "
    "spring, damper, gravity or equality"
)


# How a check that gave no answer is told, by `Outcome`.
LOSSES = {
    "timed out": "{}; give a larger --limit if that was to be expected",
    "failed": "the check ended with an exception, {}; it comes from a function of the model, or is a defect of ours",
    "lost": "{}",
}
LOST = "its process was lost: {}"


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
    force: Annotated[
        bool, typer.Option("--force", help="Let --apply replace a file that is there, even the model.")
    ] = False,
) -> None:
    """Check a model of your own against ideal joints: how wrong your settings are, why, and which are enough.

    Exit status 1 if a tolerance that was asked for is missed.
    """
    from reports.check.request import CheckRequest

    if as_schema:
        from reports.check.document import schema

        return _say(json.dumps(schema(), indent=1))
    if not 0 < limit <= 1e6:
        raise BadInput(f"--limit is {limit:g}; it must be greater than zero and at most 1e+06")
    if tolerance is not None and fix_to is not None:
        raise BadInput("--tolerance and --fix-to both name an error; give one of them")
    files = {"html": html, "markdown": markdown, "junit": junit, "apply": apply}
    drawn = not Path(model).is_dir() and (html is not None or markdown is not None)
    goal, without = tolerance if fix_to is None else fix_to, without or []
    request = CheckRequest(model, os.getcwd(), duration, goal, tuple(without), key, step, drawn, quick)
    request = replace(request, everything=everything or as_json or drawn, search=fix_to is not None)
    request = replace(request, apply=str(apply or ""))
    _refuse_bad(request, files, everything, force)
    _check(request, files, limit, as_json, everything)


def _check(
    request: CheckRequest, files: Mapping[str, Path | None], limit: float, as_json: bool, everything: bool
) -> None:
    """Check the model or those of the folder, print the answer and write the files."""
    from reports.run.worker import start_early

    start_early(*EARLY)
    begin, model = monotonic(), request.word
    answers = _answers([replace(request, word=word) for word in _models(model)], limit)
    if Path(model).is_dir():
        _print_folder(model, answers, as_json)
    else:
        _print(answers[0][1], as_json, everything)
    _write(model, answers, files, monotonic() - begin)
    _refuse_missed(answers, Path(model).is_dir())


def _refuse_missed(answers: Answers, folder: bool) -> None:
    """Raises BadInput where nothing could be written, and Broken where a tolerance is missed."""
    from reports.check.request import CheckReport

    reports = [answer for _, answer in answers if isinstance(answer, CheckReport)]
    for report in reports:
        if report.trouble:
            raise BadInput(report.trouble)
    missed = [report for report in reports if not report.fine]
    if missed and folder:
        names = ", ".join(report.request.word for report in missed)
        raise Broken(f"{len(missed)} of {len(answers)} models miss {missed[0].request.tolerance:g}: {names}")
    if missed:
        raise Broken(missed[0].verdict)


def _refuse_bad(request: CheckRequest, files: Mapping[str, Path | None], everything: bool, force: bool) -> None:
    """Raises BadInput and FileTrouble before anything is run."""
    model = request.word
    if not model:
        raise BadInput("no model was given; give model.xml, model.urdf, script.py or a folder of them")
    request.refuse_bad()
    paths = {f"--{name}": path for name, path in files.items() if path is not None}
    sources = {Path(word).resolve() for word in (model, model.rpartition(":")[0])}
    for name, path in paths.items():
        if path == STDOUT:
            raise BadInput(f"{name} is '-', and standard output has the answer already; give a file")
        if not path.name or path.is_dir():
            raise BadInput(f"{name} is {str(path)!r}, which is a folder; give a file")
        if name != "--apply" and path.resolve() in sources:
            raise BadInput(f"{name} is {str(path)!r}, which is the model; give another file")
    if "--apply" in paths:  # reports are written again, as those of pytest are
        refuse_existing([paths["--apply"]], "--apply", force)
    if len({path.resolve() for path in paths.values()}) < len(paths):
        raise BadInput(f"{' and '.join(paths)} name one file twice; give each a file of its own")
    for name in ("--apply", "--html") if Path(model).is_dir() else ():
        if name in paths:
            raise BadInput(f"{name} is for one model, and {model} is a folder; give one of its models")
    if everything and Path(model).is_dir():
        raise BadInput(f"--all is for one model, and {model} is a folder; give one of its models")


def _models(model: str) -> list[str]:
    """The model, or those of a folder. Raises BadInput for a folder without any."""
    if not Path(model).is_dir():
        return [model]
    from reports.check.folder import models

    found = [str(path) for path in models(Path(model))]
    if not found:
        raise BadInput(f"{model}: it holds no model; give a folder with MJCF, URDF or scripts that import pymunk")
    return found


def _answers(requests: list[CheckRequest], limit: float) -> Answers:
    """Each request with its answer, from supervised processes, with progress on stderr. Raises WorkersLost."""
    from reports.check.request import Refused, answered
    from reports.model.outcomes import Loss
    from reports.run.files import temporary_folder
    from reports.run.running import worker_count
    from reports.run.supervisor import supervise

    found: dict[str, CheckReport | Refused] = {}
    with temporary_folder() as folder:
        tell = _Progress(folder / "progress")
        items = [replace(each, notes=str(tell.notes)) for each in requests] if len(requests) == 1 else requests
        try:
            for item, result, _ in supervise(answered, items, limit, worker_count(), watch=tell, wall=limit + 60):
                if isinstance(result, Loss):
                    result = Refused(f"{item.word}: {LOSSES.get(result.outcome, LOST).format(result.sentence)}")
                found[item.word] = result
                if len(requests) > 1:
                    tell.show(f"{len(found)} of {len(requests)}: {item.word}")
        finally:
            tell.clear()
    return [(request, found[request.word]) for request in requests]


class _Progress:
    """A line that is overwritten on a terminal; one line for each part of the work into a file or a pipe."""

    def __init__(self, notes: Path) -> None:
        self.notes, self._said, self._begin = notes, "", monotonic()

    def __call__(self, running: list[Any]) -> None:
        with suppress(OSError):
            words = self.notes.read_text(encoding="utf-8")
            self.show(words if sys.stderr.isatty() else words.partition(",")[0])

    def show(self, words: str) -> None:
        if words and words != self._said:
            self._said, line = words, f"{monotonic() - self._begin:5.1f} s  {words}"
            line = visible(line)
            told, end = (f"{OVERWRITE}{line}", "") if sys.stderr.isatty() else (line, "\n")
            print(told, end=end, file=sys.stderr, flush=True)

    def clear(self) -> None:
        if sys.stderr.isatty() and self._said:
            print(OVERWRITE, end="", file=sys.stderr, flush=True)


def _write(model: str, answers: Answers, files: Mapping[str, Path | None], seconds: float) -> None:
    """The files that are asked for. Raises FileTrouble."""
    from reports.check import folder, rendering
    from reports.check.request import CheckReport
    from reports.run.files import write_whole
    from reports.write.tables import markdown as table

    texts, html, markdown, junit = dict[Path, str](), files["html"], files["markdown"], files["junit"]
    answer = answers[0][1]
    if markdown is not None and Path(model).is_dir():
        texts[markdown] = f"# {model}\n\n{table(folder.HEADER, folder.rows(answers), left=len(folder.HEADER))}\n"
    elif isinstance(answer, CheckReport):
        name = f"{answer.data['name']} in {answer.data['engine']}"
        if html is not None:
            texts[html] = rendering.html(name, answer.sections)
        if markdown is not None:
            drawn = [section.picture for section in answer.sections if section.picture is not None]
            paths = {title: f"{markdown.stem}_{number}.svg" for number, (title, _) in enumerate(drawn, start=1)}
            texts |= {markdown.with_name(paths[title]): drawing for title, drawing in drawn}
            texts[markdown] = rendering.markdown(name, answer.sections, paths)
    if junit is not None:
        texts[junit] = folder.junit_xml(answers, seconds)
    write_whole(texts, "give another file")


def _print_folder(model: str, answers: Answers, as_json: bool) -> None:
    from reports.check.folder import HEADER, document, rows
    from reports.cli.terminal import Terminal, print_table

    if as_json:
        return _say(json.dumps(document(answers), indent=1, allow_nan=False))
    return print_table(Terminal(WIDTH), f"Models of {model}", HEADER, rows(answers), len(HEADER))


def _print(answer: CheckReport | Refused, as_json: bool, everything: bool) -> None:
    """The answer for one model. Raises BadInput if there is none."""
    from reports.check.rendering import plain
    from reports.check.request import Refused

    if isinstance(answer, Refused):
        raise BadInput(answer.sentence)
    if as_json:
        return _say(json.dumps(answer.data, indent=1, allow_nan=False))
    width = min(WIDTH, shutil.get_terminal_size((WIDTH, 24)).columns)
    if everything:
        return _say(plain(answer.sections, width))
    written = "" if answer.data["applied"] else "; to have these settings written: --apply FILE"
    return _say(f"{plain([answer.answer], width)}All that was read, measured and tried: --all{written}.")


def _say(text: str) -> None:
    from reports.cli.streams import written

    with written():
        print(visible(text))
