"""Files written whole or not at all, and temporary folders that nothing leaves behind.

An interruption takes folders away, and the next program what a kill left: whoever made a folder holds a lock on it as
long as he lives, by which another program knows whether he does.
"""

from __future__ import annotations

import atexit
import os
import re
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

from reports.model.ending import FileTrouble

fcntl: Any
try:
    import fcntl
except ImportError:  # Windows: nothing is swept there
    fcntl = None

PREFIX, SUFFIX = ".crosscheck-", ".part"
NAME = re.compile(rf"{re.escape(PREFIX)}[a-z0-9_]{{8}}{re.escape(SUFFIX)}")  # of no folder that somebody else makes
# Sockets stand in a folder that lasts, and systems take 104 bytes of their path at least: this is what is left of them
# for the folder's place.
LONGEST_PLACE = 104 - len(f"/{PREFIX}12345678{SUFFIX}/listener-12345678") - 1
TRIES = 20  # to remove a folder into which a process writes that is just being ended

_own: dict[Path, int | None] = {}  # folder -> what holds its lock
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_own.clear)  # they stay those of the process that made them


@contextmanager
def temporary_folder(parent: Path | None = None) -> Iterator[Path]:
    """A new folder in `parent`, the system's place for such if None, that is gone afterwards. Raises OSError."""
    place = Path(tempfile.gettempdir()) if parent is None else parent
    _sweep(place)
    folder = _made(place)
    try:
        yield folder
    finally:
        _remove(folder)


@cache
def lasting_folder() -> Path:
    """A folder for as long as this process lives: for a library that removes its own only if nothing interrupts it.

    It stands in the system's place for such, or in /tmp where the name of that one is too long for a socket.
    """
    atexit.register(remove_all)
    place = Path(tempfile.gettempdir())
    too_long = len(os.fsencode(place)) > LONGEST_PLACE and os.access("/tmp", os.W_OK)
    return _made(Path("/tmp") if too_long else place)


def held_folders() -> tuple[Path, ...]:
    """The temporary folders that this process has made and not removed yet."""
    return tuple(_own)


def remove_all() -> None:
    """Remove every folder of this process that is there; for a process that ends where it stands."""
    for folder in list(_own):
        _remove(folder)


def _made(place: Path) -> Path:
    while True:
        folder = Path(tempfile.mkdtemp(SUFFIX, PREFIX, place))
        _own[folder] = None
        if fcntl is None:
            return folder
        with suppress(FileNotFoundError):  # another program found it without a lock: make another
            held = _own[folder] = os.open(folder, os.O_RDONLY)
            with suppress(OSError):  # a file system without locks: nobody sweeps there
                fcntl.flock(held, fcntl.LOCK_EX)
            if folder.is_dir():
                return folder
        _remove(folder)


def _remove(folder: Path) -> None:
    for _ in range(TRIES):
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            break
    held = _own.pop(folder, None)
    if held is not None:
        os.close(held)


@cache
def _sweep(place: Path) -> None:
    """Remove what programs that were killed have left in a place; once in a process."""
    if fcntl is None:
        return
    with suppress(OSError):
        for folder in place.iterdir():
            if NAME.fullmatch(folder.name) and folder not in _own:
                _remove_unless_held(folder)


def _remove_unless_held(folder: Path) -> None:
    with suppress(OSError):  # somebody else's, or gone
        held = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(folder, ignore_errors=True)
        finally:
            os.close(held)


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
    their names leaves some old and some new ones, each of them whole. What is no file, such as /dev/stdout or a pipe,
    is written into at the end. Raises FileTrouble, ending in the remedy.
    """
    with ExitStack() as stack:
        asides: dict[Path, Path] = {}  # folder -> a folder in it, hence on the same disk
        complete: dict[Path, Path] = {}
        streams = {path: text for path, text in texts.items() if is_stream(path)}
        for path, text in texts.items():
            if path in streams:
                continue
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
        for path in texts:
            try:
                if path in streams:
                    # At its end: /dev/stdout may lead to a file in which something stands already.
                    with path.open("a", encoding="utf-8", newline="\n") as file:
                        file.write(streams[path])
                else:
                    complete[path].replace(path)
            except OSError as reason:
                raise FileTrouble(f"{path} can't be written ({reason.strerror or reason}): {remedy}") from None


def is_stream(path: Path) -> bool:
    """Whether it is a device, a pipe or a link in /dev: a file put in its place would be there for every program."""
    link = path.is_symlink() and path.absolute().is_relative_to("/dev")  # /dev/stdout may lead to a file
    return link or (path.exists() and not path.is_file() and not path.is_dir())
