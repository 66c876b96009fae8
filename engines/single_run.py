"""What every engine that is an extra shares: how its package is found, and a run that is called once and read out."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from engines.contract import Engine, OneShot, Size, Unsupported
from engines.sampling import reactions
from reference.checks import Count, Valid, validated
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


@cache
def _is_found(module: str) -> bool:
    return find_spec(module) is not None


@cache
def _is_loaded(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


class Optional(Engine, Valid):
    """The base of an engine whose package is an extra of this project: a value even where the package is missing.

    The extra has the engine's name. `library`: a shared library of Linux that the wheel of `modules` needs and has not,
    with the package of Debian that has it; `apart`: what has to be installed besides, since pip can't in one go.
    """

    library: ClassVar[tuple[str, str] | None] = None
    apart: ClassVar[str] = ""

    @property
    def missing(self) -> str:
        """One sentence that says how to install it; empty where it is installed."""
        absent = [module for module in self.modules if not _is_found(module)]
        if not absent:
            if sys.platform != "linux" or self.library is None or _is_loaded(self.library[0]):
                return ""
            name, package = self.library
            return (
                f"{self.name} needs the shared library {name}, which is not on this system: apt-get install {package}"
            )
        then = f", then {self.apart}" if self.apart else ""
        return f"{self.name} needs the package {absent[0]}: pip install -e '.[{self.name}]'{then}"

    def require(self) -> None:
        """Raises Unsupported with the sentence where the package is missing."""
        if self.missing:
            raise Unsupported(self.missing)


@contextmanager
def quiet() -> Iterator[None]:
    """What native code prints in here goes nowhere: file descriptors 1 and 2, which Python's streams don't see."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    with tempfile.TemporaryFile() as nowhere:
        kept = [os.dup(number) for number in (1, 2)]
        try:
            for number in (1, 2):
                os.dup2(nowhere.fileno(), number)
            yield
        finally:
            for number, copy in zip((1, 2), kept, strict=True):
                os.dup2(copy, number)
                os.close(copy)


@dataclass(frozen=True)
class Recorded:
    """What an engine held at the samples, in the mechanism's order and frame; NaN where it could not go on.

    `inertias` (bodies, 3) [kg, kg, kg m^2] and `gravity` (2,) [m/s^2] are those of the engine's own objects.
    """

    pose: Array  # (samples + 1, bodies, 3)
    twist: Array
    acceleration: Array  # NaN where it can't be told
    stepping: float  # s
    inertias: Array
    gravity: Array
    warnings: tuple[str, ...] = ()


class SingleRun(OneShot):
    """A model, ready to be stepped once; see `engines.Run`."""

    def __init__(self, mechanism: Mechanism, dt: float, size: Size, record: Callable[[int, int], Recorded]) -> None:
        """`record(samples, every)` steps the model, with steps of dt [s]."""
        self._mechanism, self._dt, self._record = mechanism, dt, record
        self.size = size

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are not whole numbers above zero, RuntimeError at the second call."""
        self._mechanism.require_room(samples)
        self.begin()
        found = self._record(samples, every)
        pose, twist = found.pose.copy(), found.twist.copy()
        # Single precision rounds the start, which is the mechanism's and not the engine's.
        pose[0], twist[0] = self._mechanism.pose, self._mechanism.twist
        sound = np.isfinite([pose, twist]).all(axis=(0, 2, 3))
        lost = int(np.argmin(sound)) if not sound.all() else samples + 1
        acceleration = found.acceleration.copy()
        pose[lost:], twist[lost:], acceleration[lost:] = np.nan, np.nan, np.nan
        reaction = reactions(self._mechanism, pose, twist, acceleration, found.inertias, found.gravity)
        t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
        silent = lost <= samples and not found.warnings
        warnings = (f"ours: at {t[lost]:.4g} s the engine holds no numbers any more",) if silent else found.warnings
        return Trajectory(t, pose, twist, reaction, found.stepping, warnings)
