"""Files written whole or not at all, and what to say of a file that makes trouble."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

from reports.model.ending import FileTrouble
from reports.run.temporary import temporary_folder


def folder_for(path: Path, remedy: str) -> Path:
    """Make the folder `path` and those above it unless they are there. Raises FileTrouble, ending in the remedy."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise FileTrouble(f"{path} can't be a folder, since a file has its name or one above it: {remedy}") from None
    except OSError as reason:
        raise FileTrouble(f"the folder {path} can't be made ({reason.strerror or reason}): {remedy}") from None
    return path


def write_whole(texts: Mapping[Path, str], remedy: str) -> None:
    """Write all files, each under its name only when all are complete on disk; links are replaced, never followed.

    All are written aside first, so that a full disk or an error leaves every old file as it was. A kill while they get
    their names leaves some old and some new ones, each of them whole. Raises FileTrouble, ending in the remedy.
    """
    with ExitStack() as stack:
        asides: dict[Path, Path] = {}  # folder -> a folder in it, hence on the same disk
        complete: dict[Path, Path] = {}
        for path, text in texts.items():
            folder = folder_for(path.parent, remedy)
            try:
                if path.is_dir() and not path.is_symlink():
                    raise IsADirectoryError(None, "a folder has its name")
                if folder not in asides:
                    asides[folder] = stack.enter_context(temporary_folder(folder))
                complete[path] = asides[folder] / path.name
                with complete[path].open("w", encoding="utf-8", newline="\n") as file:
                    file.write(text)
                    file.flush()
                    os.fsync(file.fileno())
            except OSError as reason:
                raise FileTrouble(f"{path} can't be written ({reason.strerror or reason}): {remedy}") from None
        for path, aside in complete.items():
            try:
                aside.replace(path)
            except OSError as reason:
                raise FileTrouble(f"{path} can't be written ({reason.strerror or reason}): {remedy}") from None
