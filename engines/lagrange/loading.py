"""Loading of the compiled code: whether numba is installed, and the folder in which numba keeps what it has compiled.

Why numba: it compiles Python that stands beside its numpy twin, has wheels for every Python and system of this suite,
and needs no compiler; the code reads no types of a mechanism, so it is compiled once and then read from files in a
fifth of a second. Nothing of it is imported before something is stepped.

The folder's name has a digest of all that is compiled, since numba looks only at the file of the function that is
called and would go on with the old code of those that it calls. It is in NUMBA_CACHE_DIR if that is set, else beside
the sources, else, for an installation that can't be written to, in the user's cache. Processes that start at once may
each compile: numba writes whole files only.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from engines.lagrange import arrays
from engines.user_cache import cache_folder

SOURCES = Path(__file__).parent
READY = "ready"  # a file that says that all is compiled


@cache
def installed() -> bool:
    """Whether there is numba; it is not imported."""
    return find_spec("numba") is not None


def is_cold() -> bool:
    """Whether the first motion of this installation has to wait until its machine code is compiled: a minute or two."""
    return installed() and not compiled.cache_info().currsize and not (_folder() / READY).exists()


@cache
def compiled() -> Callable[..., int]:
    """`run` of `compiled.adaptive`. Raises ImportError without numba."""
    folder, config = _folder(), import_module("numba").config
    before, config.CACHE_DIR = config.CACHE_DIR, str(folder)  # where other functions are kept stays as it is
    try:
        run = import_module("engines.lagrange.compiled.adaptive").run
    finally:
        config.CACHE_DIR = before
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


@cache
def _temporary() -> tempfile.TemporaryDirectory[str]:
    """A folder of this process, for a machine on which nothing else can be written to."""
    return tempfile.TemporaryDirectory(ignore_cleanup_errors=True)


def _folder() -> Path:
    """The folder for compiled code, which exists and can be written to."""
    named: Any = os.environ.get("NUMBA_CACHE_DIR")
    for place in [Path(named)] if named else [SOURCES / "__pycache__", cache_folder()]:
        folder = place / f"lagrange-{_digest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder
    return Path(_temporary().name)
