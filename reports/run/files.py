"""Files written whole or not at all, and temporary folders that an interruption removes too."""

from __future__ import annotations

import atexit
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path

from reports.model.ending import FileTrouble

PREFIX = ".crosscheck_"
SOCKET_PATH = 104  # bytes of the path of a socket that every system takes
TRIES = 20  # to remove a folder into which a process writes that is just being ended

_folders: list[Path] = []  # the temporary folders that this process has made and not removed yet


@contextmanager
def temporary_folder(parent: Path | None = None) -> Iterator[Path]:
    """A new folder in `parent`, in the system's folder for temporary files if None, removed afterwards.

    Raises OSError.
    """
    folder = _new_folder(parent)
    try:
        yield folder
    finally:
        _remove(folder)


@cache
def socket_folder() -> Path:
    """A folder for sockets, removed at the end: in /tmp where the path of the system's folder is too long."""
    atexit.register(remove_all)
    folder = Path(tempfile.gettempdir())
    too_long = len(os.fsencode(folder)) + len(f"/{PREFIX}12345678.part/listener-12345678") >= SOCKET_PATH
    return _new_folder(Path("/tmp") if too_long and os.access("/tmp", os.W_OK) else folder)


def remove_all() -> None:
    """Remove every temporary folder of this process; for a process that ends at once."""
    for folder in tuple(_folders):
        _remove(folder)


def _new_folder(parent: Path | None) -> Path:
    folder = Path(tempfile.mkdtemp(".part", PREFIX, parent))
    _folders.append(folder)
    return folder


def _remove(folder: Path) -> None:
    for _ in range(TRIES):
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            break
    _folders.remove(folder)


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
    their names leaves some old and some new ones, each of them whole. Devices and pipes such as /dev/stdout
    are written at the end. Raises FileTrouble, ending in the remedy.
    """
    path = Path()
    try:
        with ExitStack() as stack:
            asides: dict[Path, Path] = {}  # folder -> a folder in it, hence on the same disk
            streams = [path for path in texts if is_stream(path)]
            for path in texts:
                if path in streams:
                    continue
                folder = folder_for(path.parent, remedy)
                if path.is_dir() and not path.is_symlink():
                    raise IsADirectoryError(None, "a folder has its name")
                if folder not in asides:
                    asides[folder] = stack.enter_context(temporary_folder(folder))
                with (asides[folder] / path.name).open("w", encoding="utf-8", newline="\n") as file:
                    file.write(texts[path])
                    file.flush()
                    os.fsync(file.fileno())
            for path in texts:
                if path not in streams:
                    (asides[path.parent] / path.name).replace(path)
                    continue
                with path.open("a", encoding="utf-8", newline="\n") as file:  # /dev/stdout may lead to a file
                    file.write(texts[path])
    except OSError as reason:
        raise FileTrouble(f"{path} can't be written ({reason.strerror or reason}): {remedy}") from None


def is_stream(path: Path) -> bool:
    """Whether it is a device, a pipe or a link in /dev: a file put in its place would be there for every program."""
    link = path.is_symlink() and path.absolute().is_relative_to("/dev")  # /dev/stdout may lead to a file
    return link or (path.exists() and not path.is_file() and not path.is_dir())
