"""Options that several commands share, and checks of their values."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from reports.model.ending import BadInput, FileTrouble, nearest
from reports.run.files import is_stream

FOLDER = Path("crosscheck-results")  # Relative to the current folder. Only --publish changes published results.
STORE = "cells.sqlite"
STDOUT = Path("-")  # This path means standard output.
SEARCH = "search"  # Name of the folder in FOLDER with the results of random mechanisms.
SITE = Path("crosscheck-site")
REFERENCES = "package.module:NAME, or path/to/file.py"

Folder = Annotated[Path, typer.Option("--results", help="Folder of the stored results, and of the pages.")]
Scenes = Annotated[
    list[str] | None,
    typer.Argument(help=f"Scenes or pages by name, or {REFERENCES}; all that are registered if none is named."),
]
EngineName = Annotated[str | None, typer.Option("--engine", help=f"Only this engine: its name, or {REFERENCES}.")]
VariantName = Annotated[str | None, typer.Option("--variant", help="Only this variant.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Another value for a number of the scene (repeatable)."),
]
SomeScenes = Annotated[
    list[str] | None,
    typer.Option("--scenes", help="Only these scenes (repeatable, or with commas); six short ones if none is named."),
]
Workers = Annotated[int | None, typer.Option(min=1, help="Processes; as many as processors if not given.")]
Every = Annotated[
    list[int] | None, typer.Option(min=1, max=2**31 - 1, help="Only this many steps between samples (repeatable).")
]
Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", help="Run on a Dask cluster: tcp://HOST:PORT of its scheduler, or local:N workers."),
]


DeviceName = Annotated[
    str | None,
    typer.Option("--device", help="cpu or cuda: where MJX, MuJoCo Warp and Newton run; other engines ignore it."),
]


def choose_device(device: str | None) -> None:
    """Set the device of engines for this process and its workers. Raises BadInput for an unknown device."""
    if device is not None:
        from engines.device import DEVICE, DEVICES  # The package imports numpy and scipy, which takes half a second.

        if device not in DEVICES:
            raise BadInput(f"--device {device}: it must be cpu or cuda")
        os.environ[DEVICE] = device


AsJson = Annotated[bool, typer.Option("--json", help="One JSON document, with all digits, instead of text.")]
AsMarkdown = Annotated[bool, typer.Option("--markdown", help="Markdown, as for a comment, instead of text.")]


def refuse_existing(paths: Iterable[Path], option: str, force: bool) -> None:
    """Raise FileTrouble if a file or link exists, unless `force` is true. Devices and pipes are accepted, since writing
    does not replace them."""
    for path in paths:
        if not force and (path.is_symlink() or path.exists()) and not is_stream(path):
            raise FileTrouble(f"{path} is there already: give another {option}, or --force to replace it")


def listed(option: str, words: Iterable[str], known: Iterable[str]) -> tuple[str, ...]:
    """The names in `words`. Commas may separate names, and a name may contain a comma. Raises BadInput."""
    names = tuple(known)
    found = [name.strip() for word in words for name in ([word] if word in names else word.split(","))]
    out = tuple(dict.fromkeys(filter(None, found)))
    if not out:
        raise BadInput(f"{option} names nothing; give one or some of {', '.join(names)}, with commas between them")
    for name in out:
        if name not in names:
            raise nearest(option, name, names)
    return out


def refuse_file(results: Path) -> None:
    """Raise BadInput if the folder of results or one of its parents is a file."""
    for path in (results, *results.parents):
        if path.is_file():
            raise BadInput(f"--results is {str(results)!r}, and {path} is a file; give a folder")


def with_folder(command: str, results: Path) -> str:
    """The command with the option --results for this folder, if it is not the default."""
    return command if results == FOLDER else f"{command} --results {shlex.quote(str(results))}"
