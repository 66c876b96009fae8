"""`crosscheck check MODEL`: how wrong a user's own model is at its own settings, and which settings are enough."""

from __future__ import annotations

import json
import os
import sys
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.model.ending import BadInput, Broken
from reports.run.files import write_whole

if TYPE_CHECKING:
    from reports.check.request import CheckReport

LONGEST = 1000.0  # s of motion
SUFFIX = ".svg"
# The words of `switch_off` in engines/mujoco/reading and engines/pymunk/reading, which are not imported for a help.
SWITCHED_OFF = (
    "contact, limit or sleep, in pymunk damping too, in MuJoCo frictionloss, forcelimit, armature, fluid, actuation, "
    "spring, damper, gravity or equality"
)


class Missed(Broken):
    """The model's own settings miss the tolerance."""


def check(
    model: Annotated[str, typer.Argument(help="model.xml, model.urdf, or path/to/script.py:NAME of a space.")],
    duration: Annotated[float, typer.Option(help="How long the motion is that is judged [s].")] = 2.0,
    tolerance: Annotated[float, typer.Option(help="Largest error: of angles [rad], of places in lengths.")] = 1e-4,
    html: Annotated[Path | None, typer.Option("--html", help="Write the report into this file.")] = None,
    markdown: Annotated[
        Path | None, typer.Option("--markdown", help="Write it as Markdown, pictures beside it.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print all numbers as JSON instead of the report.")] = False,
    without: Annotated[
        list[str] | None,
        typer.Option("--without", help=f"Switch off {SWITCHED_OFF} (repeatable)."),
    ] = None,
    key: Annotated[str, typer.Option(help="The stored state to begin with, or none; the first unless given.")] = "",
    step: Annotated[float | None, typer.Option(help="Your step [s], instead of the model's own.")] = None,
    limit: Annotated[float, typer.Option(help="CPU seconds after which the check is ended.")] = 120.0,
) -> None:
    """Check a model of your own against ideal joints: how wrong your settings are, and which are enough.

    Exit status 1 if the model's own settings miss the tolerance.
    """
    for name, value, most in (("duration", duration, LONGEST), ("tolerance", tolerance, 1.0), ("limit", limit, 1e6)):
        if not 0 < value <= most:
            raise BadInput(f"--{name} is {value:g}; it must be greater than zero and at most {most:g}")
    if step is not None and not 0 < step <= duration:
        raise BadInput(f"--step is {step:g}; it must be greater than zero and at most the duration, {duration:g}")
    for name, path in (("html", html), ("markdown", markdown)):
        if path is not None and (not path.name or path.is_dir()):
            raise BadInput(f"--{name} is {str(path)!r}, which is a folder; give a file")
    from reports.check.request import CheckRequest

    pictures = html is not None or markdown is not None
    request = CheckRequest(model, os.getcwd(), duration, tolerance, tuple(without or ()), key, step, pictures)
    answer = asked(request, limit)
    _write(answer, html, markdown)
    _print(answer, as_json)
    if not answer.met:
        raise Missed(answer.verdict)


def asked(request: Any, limit: float) -> CheckReport:
    """The answer to a CheckRequest, from a supervised process, with progress on stderr. Raises BadInput in one line."""
    from dataclasses import replace

    from reports.check.request import Refused, answered
    from reports.model.outcomes import Loss, Outcome
    from reports.run.files import temporary_folder
    from reports.run.supervisor import supervise

    with temporary_folder() as folder:
        notes = folder / "progress"
        tell = _Progress(notes)
        items = [replace(request, notes=str(notes))]
        try:
            for _, result, _ in supervise(answered, items, limit, workers=1, watch=tell, wall=limit + 60):
                if isinstance(result, Loss):
                    ended = result.outcome == Outcome.TIMED_OUT
                    how = result.sentence if ended else f"its process was lost: {result.sentence}"
                    remedy = "; give a larger --limit if that was to be expected" if ended else ""
                    raise BadInput(f"{request.word}: {how}{remedy}")
                if isinstance(result, Refused):
                    raise BadInput(result.sentence)
                return result
        finally:
            tell.clear()
    raise BadInput(f"{request.word}: no answer came back")


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


def _write(answer: CheckReport, html: Path | None, markdown: Path | None) -> None:
    from reports.check import rendering

    name, files = f"{answer.data['name']} in {answer.data['engine']}", dict[Path, str]()
    if html is not None:
        files[html] = rendering.html(name, answer.sections)
    if markdown is not None:
        drawn = [section.picture for section in answer.sections if section.picture is not None]
        paths = {title: f"{markdown.stem}_{number}{SUFFIX}" for number, (title, _) in enumerate(drawn, start=1)}
        files |= {markdown.with_name(paths[title]): drawing for title, drawing in drawn}
        files[markdown] = rendering.markdown(name, answer.sections, paths)
    if files:
        write_whole(files, "give another file")


def _print(answer: CheckReport, as_json: bool) -> None:
    from reports.check import rendering
    from reports.cli.terminal import written

    text = json.dumps(answer.data, indent=1, allow_nan=False) if as_json else rendering.plain(answer.sections)
    with written():
        print(text)
