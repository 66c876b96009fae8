"""A scene, and engines with known errors and failures, for tests of the reports."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from engines import ConvergenceOrder, Enforcement, Engine, NotDeclared, Size, Unsupported
from reference.joints import Joint, Pin
from reference.mechanism import Body, Mechanism
from reference.scene import Scene
from reference.trajectory import Trajectory


def in_process(work: Callable[[Any], Any], items: Iterable[Any], *_: Any, **__: Any) -> Iterator[tuple[Any, Any, str]]:
    """A substitute for `supervise` without worker processes, which take seconds to start."""
    return ((item, work(item), "") for item in items)


@dataclass(frozen=True)
class Disc(Scene):
    """A disc turns at a constant rate [rad/s] on a pin through its centre, which carries the weight."""

    name: ClassVar[str] = "disc"
    source: ClassVar[str] = "invented"

    rate: float = 2.0
    duration: float = 0.2
    horizon: float = 0.2

    def mechanism(self) -> Mechanism:
        disc = Body("disc", 1.0, 0.5, (0.0, 0.0, 0.0), (0.0, 0.0, self.rate))
        return Mechanism((disc,), (Pin("axle", None, "disc", (0.0, 0.0), (0.0, 0.0)),), (0.0, -10.0))

    def _motion(self, times: NDArray[np.float64]) -> Trajectory:
        return turning(self.mechanism(), times)

    def branch_of(self, pose: NDArray[np.float64]) -> NDArray[np.int_]:
        """Branch -1 begins at 2 rad, which the motion never reaches."""
        return np.where(pose[..., 0, 2] > 2.0, -1, 1)


class OtherDisc(Disc):
    name: ClassVar[str] = "other_disc"


@dataclass(frozen=True)
class ImpossibleDisc(Disc):
    """A scene with a mechanism and without a reference motion."""

    name: ClassVar[str] = "impossible_disc"

    def _motion(self, times: NDArray[np.float64]) -> Trajectory:
        raise ValueError("no such motion")


def turning(mechanism: Mechanism, t: NDArray[np.float64]) -> Trajectory:
    pose, twist = np.zeros((len(t), 1, 3)), np.zeros((len(t), 1, 3))
    pose[:, 0, 2], twist[:, 0, 2] = mechanism.twist[0, 2] * t, mechanism.twist[0, 2]
    return Trajectory(t, pose, twist, np.tile([0.0, 10.0], (len(t), 1)), 1e-4)


class ToyRun:
    def __init__(self, mechanism: Mechanism, dt: float, spoil: Callable[[Trajectory, float], Trajectory]) -> None:
        self.size = Size(1, 3, 2, 2)
        self._mechanism, self._dt, self._spoil = mechanism, dt, spoil

    def __call__(self, samples: int, every: int) -> Trajectory:
        t = np.arange(samples + 1, dtype=float) * every * self._dt
        return self._spoil(turning(self._mechanism, t), self._dt)


class Plain(Engine):
    """Base of test engines with simple members of the contract, without name and model."""

    packages = ()

    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return NotDeclared("no order is derived")

    def step_cost(self, mechanism: Mechanism) -> float:
        return 50e-6

    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return "engine"


@dataclass(frozen=True)
class Toy(Plain):
    """An engine whose angle error grows linearly in time to `factor` * step ** `power` + `plateau`."""

    variant: str = "default"
    factor: float = 1.0
    power: float = 2.0
    plateau: float = 0.0
    name: str = "toy"

    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return ConvergenceOrder(self.power)

    def build(self, mechanism: Mechanism, dt: float) -> ToyRun:
        return ToyRun(mechanism, dt, self.spoil)

    def spoil(self, exact: Trajectory, dt: float) -> Trajectory:
        exact.pose[:, 0, 2] += (self.factor * dt**self.power + self.plateau) * exact.t / exact.t[-1]
        return exact


@dataclass(frozen=True)
class SlowToy(Toy):
    """An engine that sleeps [s] while it builds."""

    seconds: float = 0.02

    def build(self, mechanism: Mechanism, dt: float) -> ToyRun:
        time.sleep(self.seconds)
        return super().build(mechanism, dt)


@dataclass(frozen=True)
class FailingToy(Toy):
    """An engine whose variant is a key of FAILURES."""

    def build(self, mechanism: Mechanism, dt: float) -> ToyRun:
        match self.variant:
            case "refuse":
                raise ValueError("mass is -1; it must be greater than zero")
            case "unsupported":
                raise Unsupported("it has no pins")
            case _:
                pass
        return super().build(mechanism, dt)

    def spoil(self, exact: Trajectory, dt: float) -> Trajectory:
        match self.variant:
            case "abort":
                os.write(2, b"Aborting due to Toy error: no such thing\n")
                os.abort()
            case "exit":
                os._exit(3)
            case "hang":
                while True:
                    time.sleep(1)
            case "raise":
                raise RuntimeError("something else")
            case "nan":
                exact.pose[3:] = np.nan
            case "blind":
                exact.twist[3:] = np.nan
            case "mute":
                exact.reaction[len(exact.t) // 2 :] = np.nan
            case "flip":
                exact.pose[5:, 0, 2] += 3.0
            case "tear":
                exact.pose[5:, 0, 0] = 0.3
            case "reset":
                exact.pose[5:] = np.nan
                return Trajectory(exact.t, exact.pose, exact.twist, exact.reaction, 1e-4, reset_at=float(exact.t[5]))
            case "saturate":
                exact.pose[:, 0, 2] += 5 * exact.t
            case _:
                pass
        return exact


FAILURES = {
    "abort": "aborted",
    "exit": "aborted",
    "hang": "timed out",
    "raise": "failed",
    "nan": "diverged",
    "blind": "diverged",
    "mute": "failed",
    "refuse": "refused",
    "unsupported": "unsupported",
    "tear": "torn",
    "reset": "reset",
    "flip": "branch flip",
    "saturate": "saturated",
}
