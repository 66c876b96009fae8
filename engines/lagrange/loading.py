"""Load the compiled functions, and choose the folder in which numba caches machine code.

The argument types are the same for every mechanism, so each function is compiled once. Later processes read the machine
code from files in a fraction of a second. numba is imported at the first step.

numba's cache checks the source file of a called function, but not the sources of the functions that it calls. The name
of the folder therefore contains a digest of all sources. The folder is in NUMBA_CACHE_DIR if this variable is set.
Otherwise the folder is next to the sources, or in the user's cache folder if the installation is read-only. If several
processes need the same functions, one of them compiles, and the others wait (`compiling_once`).
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from engines.user_cache import cache_folder

SOURCE_FOLDER = Path(__file__).parent
COMPILING_NOTE = "compiling the judge's machine code, once for this installation: up to two minutes"


@cache
def installed() -> bool:
    return find_spec("numba") is not None


def is_cold(adaptive: bool) -> bool:
    """Whether the next run with adaptive or fixed steps must first be compiled, which may take two minutes."""
    index = "*adaptive_steps*.nbi" if adaptive else "*fixed_steps*.nbi"
    return installed() and not any(_cache_folder().rglob(index))


def numpy_seconds() -> float:
    """The CPU time [s] that motions have taken in numpy because the machine code was missing."""
    try:
        return float(sum(map(float, _numpy_record().read_text(encoding="ascii").split())))
    except (OSError, ValueError):
        return 0.0


def add_numpy_seconds(seconds: float) -> None:
    with suppress(OSError), _numpy_record().open("a", encoding="ascii") as record:
        record.write(f"{seconds:.3f}\n")


def _numpy_record() -> Path:
    return _cache_folder() / "numpy-seconds.txt"


@contextmanager
def compiling_once(adaptive: bool) -> Iterator[None]:
    """Wait until no other process compiles the functions of such a run, so that this one reads their machine code.

    The system releases the lock of a process that is killed. Without file locks each process compiles.
    """
    with ExitStack() as stack:
        if is_cold(adaptive):
            with suppress(ImportError, OSError):
                from fcntl import LOCK_EX, flock  # not on Windows

                flock(stack.enter_context((_cache_folder() / "lock").open("w")), LOCK_EX)
        yield


class CompiledFunctions(NamedTuple):
    fixed_steps: Callable[..., int]
    adaptive_steps: Callable[..., int]
    evaluate_samples: Callable[..., int]


@cache
def compiled() -> CompiledFunctions:
    """The compiled functions; raises ImportError without numba."""
    config = import_module("numba").config
    default, config.CACHE_DIR = config.CACHE_DIR, str(_cache_folder())  # for the following definitions
    try:
        steps = import_module("engines.lagrange.compiled.steps")
        adaptive = import_module("engines.lagrange.compiled.adaptive")
    finally:
        config.CACHE_DIR = default
    return CompiledFunctions(steps.fixed_steps, adaptive.adaptive_steps, steps.evaluate_samples)


def _digest() -> str:
    digest = hashlib.sha256()
    for source in (SOURCE_FOLDER / "records.py", *sorted((SOURCE_FOLDER / "compiled").glob("*.py"))):
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


@cache
def _temporary_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(ignore_cleanup_errors=True)


@cache
def _cache_folder() -> Path:
    """The folder for machine code, which exists and is writable."""
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
