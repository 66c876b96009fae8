"""Base classes for engines whose packages are extras, and for their runs."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from abc import abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability
from engines.contract import Enforcement, Engine, OneShot, Size, Unsupported
from engines.sampling import reactions
from reference.checks import Count, Positive, Valid, validated
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning, Trajectory

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


@contextmanager
def quiet() -> Iterator[None]:
    """Discard output to file descriptors 1 and 2, also from native code."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    with tempfile.TemporaryFile() as nowhere:
        copies = [os.dup(number) for number in (1, 2)]
        try:
            for number in (1, 2):
                os.dup2(nowhere.fileno(), number)
            yield
        finally:
            for number, copy in zip((1, 2), copies, strict=True):
                os.dup2(copy, number)
                os.close(copy)


@dataclass(frozen=True)
class Recorded:
    """The recorded states, in the mechanism's order of bodies and frame, or NaN after the engine fails.

    `inertias` (bodies, 3) [kg, kg, kg m^2] and `gravity` (2,) [m/s^2] are read from the engine's objects.
    """

    pose: Array  # (samples + 1, bodies, 3)
    twist: Array
    acceleration: Array  # NaN if unknown.
    stepping: float  # CPU time [s].
    inertias: Array
    gravity: Array
    warnings: tuple[RunWarning, ...] = ()


class SingleRun(OneShot):
    def __init__(self, mechanism: Mechanism, dt: float, size: Size, record: Callable[[int, int], Recorded]) -> None:
        """`record(samples, every)` steps the model by steps of dt [s] and returns the states."""
        self._mechanism, self._dt, self._record = mechanism, dt, record
        self.size = size

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are no positive whole numbers, and RuntimeError at the second call."""
        self._mechanism.require_room(samples)
        self.begin()
        recorded = self._record(samples, every)
        pose, twist, acceleration = recorded.pose.copy(), recorded.twist.copy(), recorded.acceleration.copy()
        # An engine in single precision rounds the initial state.
        pose[0], twist[0] = self._mechanism.pose, self._mechanism.twist
        valid = np.isfinite([pose, twist]).all(axis=(0, 2, 3))
        lost = int(np.argmin(valid)) if not valid.all() else samples + 1
        pose[lost:], twist[lost:], acceleration[lost:] = np.nan, np.nan, np.nan
        reaction = reactions(self._mechanism, pose, twist, acceleration, recorded.inertias, recorded.gravity)
        t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
        warnings = recorded.warnings
        if lost <= samples and not warnings:
            text = f"ours: at {t[lost]:.4g} s the engine holds no numbers any more"
            warnings = (RunWarning(text, "lost", "adapter", float(t[lost])),)
        return Trajectory(t, pose, twist, reaction, recorded.stepping, warnings)


class EngineModel(Protocol):
    """A model that an adapter builds for steps of dt."""

    @property
    def size(self) -> Size: ...
    def record(self, samples: int, every: int) -> Recorded: ...


class ExtraEngine(Engine, Valid):
    """The base class of an engine whose package is an extra of this project.

    The extra has the engine's name. Instances can be created without the package.
    library: shared library of Linux that the wheel needs but does not contain, and its Debian package.
    apart: second pip command that the engine needs.
    capability: elements that the adapter builds.
    """

    library: ClassVar[tuple[str, str] | None] = None
    apart: ClassVar[str] = ""
    capability: ClassVar[Capability]  # pyright: ignore[reportIncompatibleVariableOverride]

    @property
    def missing(self) -> str:
        """One sentence that says how to install the package; empty if it is installed."""
        absent = [module for module in self.modules if not _is_found(module)]
        if absent:
            then = f", then {self.apart}" if self.apart else ""
            return f"{self.name} needs the package {absent[0]}: pip install -e '.[{self.name}]'{then}"
        if sys.platform != "linux" or self.library is None or _is_loaded(self.library[0]):
            return ""
        name, package = self.library
        return f"{self.name} needs the shared library {name}, which is not on this system: apt-get install {package}"

    def require(self) -> None:
        if self.missing:
            raise Unsupported(self.missing)

    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return "engine"

    @abstractmethod
    def model(self, mechanism: Mechanism, dt: float) -> EngineModel:
        """Make the model for steps of dt [s]; raises Unsupported for settings that the adapter cannot build."""

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> SingleRun:
        self.capability.require(mechanism)
        self.require()
        model = self.model(mechanism, dt)
        return SingleRun(mechanism, dt, model.size, model.record)
