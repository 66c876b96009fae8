"""Functions that write all files or none, and temporary folders that are also removed after an interruption."""

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
SOCKET_PATH = 104  # Every system accepts paths of sockets with fewer bytes.
TRIES = 20  # Number of attempts to remove a folder, into which a process that is being killed may still write.

_folders: list[Path] = []  # The existing temporary folders of this process.


@contextmanager
def temporary_folder(parent: Path | None = None) -> Iterator[Path]:
    """A context with a new folder in `parent`, or in the system's temporary folder, which is removed at the end."""
    folder = _new_folder(parent)
    try:
        yield folder
    finally:
        _remove(folder)


@cache
def socket_folder() -> Path:
    """A temporary folder for sockets, in /tmp if the path of the system's temporary folder is too long."""
    atexit.register(remove_all)
    folder = Path(tempfile.gettempdir())
    too_long = len(os.fsencode(folder)) + len(f"/{PREFIX}12345678.part/listener-12345678") >= SOCKET_PATH
    return _new_folder(Path("/tmp") if too_long and os.access("/tmp", os.W_OK) else folder)


def remove_all() -> None:
    """Remove all temporary folders of this process before an exit without cleanup."""
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
    """Create the folder `path` and its parents. Raises FileTrouble with a message that ends in `remedy`."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise FileTrouble(f"{path} can't be a folder, since a file has its name or one above it: {remedy}") from None
    except OSError as reason:
        raise FileTrouble(f"the folder {path} can't be made ({reason.strerror or reason}): {remedy}") from None
    return path


def write_whole(texts: Mapping[Path, str], remedy: str) -> None:
    """Write all files or no file. Symbolic links are replaced by files. The files are first written under temporary
    names, so an error, such as a full disk, changes no old file. If the process is killed while files are renamed, old
    and new files remain, and all are complete. Devices and pipes such as /dev/stdout are written last. Raises
    FileTrouble with a message that ends in `remedy`."""
    path = Path()
    try:
        with ExitStack() as stack:
            asides: dict[Path, Path] = {}  # Folder -> a temporary folder in this folder, on the same disk.
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
                with path.open("a", encoding="utf-8", newline="\n") as file:  # /dev/stdout may be a file
                    file.write(texts[path])
    except OSError as reason:
        raise FileTrouble(f"{path} can't be written ({reason.strerror or reason}): {remedy}") from None


def is_stream(path: Path) -> bool:
    """Whether the path is a device, a pipe or a link in /dev, which a file must not replace."""
    link = path.is_symlink() and path.absolute().is_relative_to("/dev")  # /dev/stdout may link to a file.
    return link or (path.exists() and not path.is_file() and not path.is_dir())
