"""Loading of the compiled functions, and the folder in which numba caches their machine code.

numba compiles Python functions, has wheels for all systems of this suite, and needs no compiler. The types of the
arguments are the same for every mechanism, so each function is compiled once, and read from files in a fraction of a
second afterwards. numba is imported when something is stepped, not before.

numba's own cache checks the file of the called function only, and would use old machine code after a change in one of
the functions that it calls. The folder's name therefore contains a digest of all sources. The folder is in
NUMBA_CACHE_DIR if that is set; else beside the sources; else, for a read-only installation, in the user's cache.
Processes that start at once may each compile: numba replaces whole files only.
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
from typing import NamedTuple

from engines.user_cache import cache_folder

SOURCE_FOLDER = Path(__file__).parent


@cache
def installed() -> bool:
    """Whether numba is installed; it is not imported."""
    return find_spec("numba") is not None


def is_cold(adaptive: bool) -> bool:
    """Whether a first run with adaptive (the judge) or fixed steps has to wait for the compiler: up to two minutes."""
    index = "*adaptive_steps*.nbi" if adaptive else "*fixed_steps*.nbi"
    return installed() and not any(_cache_folder().rglob(index))


class CompiledFunctions(NamedTuple):
    """The functions of the package `compiled` that Python calls."""

    fixed_steps: Callable[..., int]
    adaptive_steps: Callable[..., int]
    evaluate_samples: Callable[..., int]


@cache
def compiled() -> CompiledFunctions:
    """The compiled functions; raises ImportError without numba."""
    config = import_module("numba").config
    default, config.CACHE_DIR = config.CACHE_DIR, str(_cache_folder())  # read by numba when functions are defined
    try:
        steps = import_module("engines.lagrange.compiled.steps")
        adaptive = import_module("engines.lagrange.compiled.adaptive")
    finally:
        config.CACHE_DIR = default
    return CompiledFunctions(steps.fixed_steps, adaptive.adaptive_steps, steps.evaluate_samples)


def _digest() -> str:
    """A digest of the sources of the compiled functions and of their records."""
    digest = hashlib.sha256()
    for source in (SOURCE_FOLDER / "records.py", *sorted((SOURCE_FOLDER / "compiled").glob("*.py"))):
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


@cache
def _temporary_folder() -> tempfile.TemporaryDirectory[str]:
    """A folder of this process, if no other one can be written to."""
    return tempfile.TemporaryDirectory(ignore_cleanup_errors=True)


@cache
def _cache_folder() -> Path:
    """The folder for machine code; it exists and can be written to."""
    configured = os.environ.get("NUMBA_CACHE_DIR")
    for parent in [Path(configured)] if configured else [SOURCE_FOLDER / "__pycache__", cache_folder()]:
        folder = parent / f"lagrange-{_digest()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder
    return Path(_temporary_folder().name)
