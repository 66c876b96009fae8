"""`crosscheck check MODEL` prints the error of a user's model, and settings that meet a tolerance."""

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
from typing import Annotated, Any

import typer

from reports.check import folder as many
from reports.check.folder import Answers
from reports.check.request import CheckReport, CheckRequest, Refused, run_check
from reports.cli.options import STDOUT, refuse_existing
from reports.cli.streams import written
from reports.model.ending import BadInput, Broken, visible
from reports.model.outcomes import Loss
from reports.run import supervisor, worker
from reports.run.files import temporary_folder, write_whole

MAX_WIDTH = 120  # Largest number of columns of the output.
OVERWRITE = "\r\x1b[K"  # Erases the current line of a terminal.
# The fork server imports these modules while this process reads the options and the model.
EARLY = ("reports.check.document", "reports.check.telling", "scipy.integrate", "llvmlite.binding")
# Names that `switch_off` of the readers for MuJoCo and pymunk accepts. --help does not import the readers.
SWITCHED_OFF = (
    "contact, limit or sleep, in pymunk damping too, in MuJoCo frictionloss, forcelimit, armature, fluid, actuation, "
    "spring, damper, gravity or equality"
)
# Outcome -> a sentence on a check without a result.
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
    """Check a model of your own against ideal joints: how wrong your settings are, why, and which ones suffice. The
    exit status is 1 if the model misses the given tolerance."""
    if as_schema:
        from reports.check.document import schema  # This imports engines.

        return _say(json.dumps(schema(), indent=1))
    if not 0 < limit <= 1e6:
        raise BadInput(f"--limit is {limit:g}; it must be greater than zero and at most 1e+06")
    if tolerance is not None and fix_to is not None:
        raise BadInput("--tolerance and --fix-to both name an error; give one of them")
    files = {"html": html, "markdown": markdown, "junit": junit, "apply": apply}
    drawing = not Path(model).is_dir() and (html is not None or markdown is not None)
    goal, elements = tolerance if fix_to is None else fix_to, tuple(without or ())
    request = CheckRequest(model, os.getcwd(), duration, goal, elements, key, step, drawing, quick)
    all_settings = everything or as_json or drawing
    request = replace(request, everything=all_settings, search=fix_to is not None, apply=str(apply or ""))
    _refuse_bad(request, files, everything, force)
    worker.start_early(*EARLY)
    begin = monotonic()
    answers = _answers([replace(request, word=label) for label in _models(model)], limit)
    _print(model, answers, as_json, everything)
    _write(model, answers, files, monotonic() - begin)
    _refuse_missed(answers, Path(model).is_dir())


def _refuse_missed(answers: Answers, is_folder: bool) -> None:
    reports = [answer for _, answer in answers if isinstance(answer, CheckReport)]
    for report in reports:
        if report.trouble:
            raise BadInput(report.trouble)
    missed = [report for report in reports if not report.fine]
    if missed and is_folder:
        names = ", ".join(report.request.word for report in missed)
        raise Broken(f"{len(missed)} of {len(answers)} models miss {missed[0].request.tolerance:g}: {names}")
    if missed:
        raise Broken(missed[0].verdict)


def _refuse_bad(request: CheckRequest, files: Mapping[str, Path | None], everything: bool, force: bool) -> None:
    model = request.word
    if not model:
        raise BadInput("no model was given; give model.xml, model.urdf, script.py or a folder of them")
    request.refuse_bad()
    paths = {f"--{name}": path for name, path in files.items() if path is not None}
    sources = {Path(label).resolve() for label in (model, model.rpartition(":")[0])}
    for name, path in paths.items():
        if path == STDOUT:
            raise BadInput(f"{name} is '-', and standard output has the answer already; give a file")
        if not path.name or path.is_dir():
            raise BadInput(f"{name} is {str(path)!r}, which is a folder; give a file")
        if name != "--apply" and path.resolve() in sources:
            raise BadInput(f"{name} is {str(path)!r}, which is the model; give another file")
    if "--apply" in paths:  # Reports may replace older files, as in pytest.
        refuse_existing([paths["--apply"]], "--apply", force)
    if len({path.resolve() for path in paths.values()}) < len(paths):
        raise BadInput(f"{' and '.join(paths)} name one file twice; give each a file of its own")
    if Path(model).is_dir():
        for name in [name for name in ("--apply", "--html") if name in paths] + ["--all"] * everything:
            raise BadInput(f"{name} is for one model, and {model} is a folder; give one of its models")


def _models(model: str) -> list[str]:
    if not Path(model).is_dir():
        return [model]
    paths = [str(path) for path in many.find_models(Path(model))]
    if not paths:
        raise BadInput(f"{model}: it holds no model; give a folder with MJCF, URDF or scripts that import pymunk")
    return paths


def _answers(requests: list[CheckRequest], limit: float) -> Answers:
    answers: dict[str, CheckReport | Refused] = {}
    with temporary_folder() as aside:
        progress = _Progress(aside / "progress")
        items = (
            [replace(request, notes=str(progress.notes)) for request in requests] if len(requests) == 1 else requests
        )
        options: Any = {"watch": progress, "wall": limit + 60}
        try:
            for item, result, _ in supervisor.supervise(run_check, items, limit, worker.worker_count(), **options):
                if isinstance(result, Loss):
                    result = Refused(f"{item.word}: {LOSSES.get(result.outcome, LOST).format(result.sentence)}")
                answers[item.word] = result
                if len(requests) > 1:
                    progress.show(f"{len(answers)} of {len(requests)}: {item.word}")
        finally:
            progress.clear()
    return [(request, answers[request.word]) for request in requests]


class _Progress:
    """Prints the progress, which overwrites one line of a terminal. A file or a pipe gets a line for each stage."""

    def __init__(self, notes: Path) -> None:
        self.notes, self._last, self._begin = notes, "", monotonic()

    def __call__(self, running: list[Any]) -> None:
        with suppress(OSError):
            text = self.notes.read_text(encoding="utf-8")
            self.show(text if sys.stderr.isatty() else text.partition(",")[0])

    def show(self, words: str) -> None:
        if words and words != self._last:
            self._last, line = words, visible(f"{monotonic() - self._begin:5.1f} s  {words}")
            start, end = (OVERWRITE, "") if sys.stderr.isatty() else ("", "\n")
            print(f"{start}{line}", end=end, file=sys.stderr, flush=True)

    def clear(self) -> None:
        if sys.stderr.isatty() and self._last:
            print(OVERWRITE, end="", file=sys.stderr, flush=True)


def _write(model: str, answers: Answers, files: Mapping[str, Path | None], seconds: float) -> None:
    from reports.check import rendering  # Imported here, so that invalid options are refused sooner.
    from reports.write.tables import markdown as table

    texts, html, markdown, junit = dict[Path, str](), files["html"], files["markdown"], files["junit"]
    answer = answers[0][1]
    if markdown is not None and Path(model).is_dir():
        texts[markdown] = (
            f"# {model}\n\n{table(many.FOLDER_HEADER, many.rows(answers), left=len(many.FOLDER_HEADER))}\n"
        )
    elif isinstance(answer, CheckReport):
        name = f"{answer.data['name']} in {answer.data['engine']}"
        if html is not None:
            texts[html] = rendering.html(name, answer.sections)
        if markdown is not None:
            pictures = [section.picture for section in answer.sections if section.picture is not None]
            paths = {title: f"{markdown.stem}_{number}.svg" for number, (title, _) in enumerate(pictures, start=1)}
            texts |= {markdown.with_name(paths[title]): drawing for title, drawing in pictures}
            texts[markdown] = rendering.markdown(name, answer.sections, paths)
    if junit is not None:
        texts[junit] = many.junit_xml(answers, seconds)
    write_whole(texts, "give another file")


def _print(model: str, answers: Answers, as_json: bool, everything: bool) -> None:
    from reports.check import rendering

    if Path(model).is_dir():
        if as_json:
            return _say(json.dumps(many.document(answers), indent=1, allow_nan=False))
        from reports.cli.terminal import Terminal, print_table

        left = len(many.FOLDER_HEADER)
        return print_table(Terminal(MAX_WIDTH), f"Models of {model}", many.FOLDER_HEADER, many.rows(answers), left)
    answer = answers[0][1]
    if isinstance(answer, Refused):
        raise BadInput(answer.sentence)
    if as_json:
        return _say(json.dumps(answer.data, indent=1, allow_nan=False))
    width = min(MAX_WIDTH, shutil.get_terminal_size((MAX_WIDTH, 24)).columns)
    if everything:
        return _say(rendering.plain(answer.sections, width))
    hint = "" if answer.data["applied"] else "; to have these settings written: --apply FILE"
    return _say(f"{rendering.plain([answer.answer], width)}All that was read, measured and tried: --all{hint}.")


def _say(text: str) -> None:
    with written():
        print(visible(text))
