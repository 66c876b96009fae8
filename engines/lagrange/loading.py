"""Compiled code when it is first needed: whether numba is there, and where what it has compiled is kept.

Why numba: it compiles Python that stands beside its numpy twin, has wheels for every Python and system of this suite,
and needs no compiler; the code reads no types of a mechanism, so it is compiled once and then read from files in a
fifth of a second. Nothing of it is imported before something is stepped.

The files stand in a folder that is named by a digest of all that is compiled, since numba looks only at the
file of the function that is called and would go on with the old code of those that it calls. The folder is in
NUMBA_CACHE_DIR if that is set, else beside the sources, else, for an installation that can't be written to, in the
user's cache. The first process compiles while the others wait at a lock. Without any folder each process compiles.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from engines.lagrange import arrays

SOURCES = Path(__file__).parent
READY = "ready"  # a file that says that all is compiled


@cache
def installed() -> bool:
    """Whether there is numba; it is not imported."""
    return find_spec("numba") is not None


def is_cold() -> bool:
    """Whether the first motion of this installation has to wait until its machine code is compiled: a minute or two."""
    if not installed() or compiled.cache_info().currsize:
        return False
    folder = _folder()
    return folder is None or not (folder / READY).exists()


def _entry() -> Any:
    # By its name as it stands: so fingerprints of rows know what they depend on.
    return import_module("engines.lagrange.compiled.entry")


@cache
def compiled() -> Callable[..., int]:
    """`run` of `compiled.entry`. Raises ImportError without numba."""
    folder = _folder()
    with _alone(folder), _kept_in(folder):
        run = _entry().run
        if folder is not None:
            with contextlib.suppress(OSError):  # a full disk: the next process compiles again
                (folder / READY).touch()
    return run


def _digest() -> str:
    """Of the sources of the compiled code, and of the constants that it takes from elsewhere."""
    digest = hashlib.sha256()
    for source in sorted((SOURCES / "compiled").glob("*.py")):
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    constants = {(name, value) for name, value in vars(arrays).items() if type(value) is int}
    digest.update(repr(sorted(constants)).encode())
    return digest.hexdigest()[:16]


def _beside() -> Path:
    return SOURCES / "__pycache__"


def _folder() -> Path | None:
    """Where compiled code is kept, made if need be; None if nowhere can be written to."""
    named = os.environ.get("NUMBA_CACHE_DIR")
    users = os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    places = [Path(named)] if named else [_beside(), Path(users) / "planar-crosscheck"]
    for place in places:
        folder = place / f"lagrange-{_digest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder
    return None


@contextlib.contextmanager
def _kept_in(folder: Path | None) -> Iterator[None]:
    """numba told where to keep what is compiled meanwhile; what others compile stays where they want it."""
    config: Any = import_module("numba").config
    before = config.CACHE_DIR
    if folder is None:
        # Somewhere it must write: a folder of this process, gone as soon as all is compiled.
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as own:
            config.CACHE_DIR = own
            try:
                yield
            finally:
                config.CACHE_DIR = before
        return
    config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before


@contextlib.contextmanager
def _alone(folder: Path | None) -> Iterator[None]:
    """Wait for another process that compiles; nobody waits once all is ready, nor where locks don't exist."""
    if folder is None or (folder / READY).exists() or sys.platform == "win32":
        yield
        return
    import fcntl

    with (folder / "lock").open("w", encoding="utf-8") as lock:
        with contextlib.suppress(OSError):  # a file system without locks: both compile, and numba's files are whole
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield
