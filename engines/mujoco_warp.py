"""MuJoCo Warp under test: MuJoCo's model, stepped by kernels of NVIDIA Warp in single precision, here on the processor.

Our MuJoCo adapter compiles the model, as for `engines.mjx`. MuJoCo Warp has the velocity term (dJ/dt) v of loops, which
MJX omits ([mujoco_warp#1294](https://github.com/google-deepmind/mujoco_warp/pull/1294)). In version 4.0.0 this term
contains the bodies' velocities of the previous evaluation, since `fwd_position` makes the constraints before
`fwd_velocity` computes the velocities. Runs with loops have a warning. For reactions our adapter evaluates a state
twice, so that the term contains the velocities of this state.

The adapter captures a step as a graph and launches it again, as the documentation recommends for a GPU
(`mujoco.readthedocs.io`, "MuJoCo Warp").

Rounding determines the settings of *tuned*. In single precision a loop is open by about 6e-8 m. With a time constant of
5 ms, this gap causes an acceleration of 2.5e-3 m/s^2, which is 0.4 % of the first acceleration of a four-bar. A small
compliance also makes the solver's equations ill-conditioned. Therefore the stiffest `solimp`, 0.9999, is not the best.
`put_model` raises the solver's tolerance to at least 1e-6. Without a tolerance a step takes ten times as long, and the
error is not smaller. Our adapter sets the tolerance after `put_model`, relative to the inertia of the coordinates
without drives (`engines.mujoco.model`). Otherwise the large inertia of a drive would end the solver at once.

Warp compiles kernels at their first use. The compilation takes minutes for the first model on a computer, and seconds
for a model of another structure. Warp's variable WARP_CACHE_PATH names the folder of the compiled kernels.

The package mujoco-warp requires the package mujoco, which overwrites the files of mujoco-core. Therefore install
mujoco-warp without dependencies: pip install --no-deps mujoco-warp. Newton's solver `SolverMuJoCo` uses this package.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability
from engines.contract import SINGLE_PRECISION, ConvergenceOrder, NotDeclared, Unsupported
from engines.device import chosen_device
from engines.mujoco.methods import TUNED as C_TUNED
from engines.mujoco.model import MuJoCoModel
from engines.mujoco.stiffness import TiedToStep
from engines.on_device import MuJoCoOnDevice, size_of, without_contacts
from engines.sampling import sampled
from engines.single_run import Recorded, quiet
from engines.tree import spanning_tree
from reference.checks import validated
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning

Array = NDArray[np.float64]
# The smallest tolerance that `put_model` permits.
LEAST_TOLERANCE = 1e-6
LATE_VELOCITY_TERM = RunWarning(
    "upstream: the velocity term of loops in MuJoCo Warp has the bodies' velocities of the evaluation before",
    "known fault",
    "upstream",
)


@dataclass(frozen=True)
class StiffInSinglePrecision(TiedToStep):
    """The stiffness at which a loop's compliance and rounding cause errors of about the same size."""

    impedance: ClassVar[tuple[float, float, float, float, float]] = (0.997, 0.997, 0.001, 0.5, 1.0)
    steps: float = 2.5


@dataclass(frozen=True)
class MuJoCoWarp(MuJoCoOnDevice):
    name = "mujoco-warp"
    title: ClassVar[str] = "MuJoCo Warp"
    evaluation_cost: ClassVar[float] = 17e-6
    packages = ("mujoco-warp", "warp-lang", "mujoco-core")
    modules: ClassVar[tuple[str, ...]] = ("warp", "mujoco_warp")
    apart: ClassVar[str] = "pip install --no-deps mujoco-warp"
    precision: ClassVar[float] = SINGLE_PRECISION
    capability: ClassVar[Capability] = without_contacts("mujoco-warp", "MuJoCo Warp")

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        if spanning_tree(mechanism).closed:
            return NotDeclared("the stiffness of loops multiplies the rounding of single precision")
        return replace(self.order_without_loops(mechanism), amplified=self.precision / np.finfo(float).eps)

    def model(self, mechanism: Mechanism, dt: float) -> WarpModel:
        model = self.compiled(mechanism, dt)
        try:
            return WarpModel(model, self.settings.tolerance)
        except NotImplementedError as reason:
            raise self.refusal(reason) from None

    def stricter(self, mechanism: Mechanism) -> None:
        """None, since the tolerance is already near the rounding."""


@cache
def load_warp(device: str) -> Any:
    """Import warp, which then prints only errors; raises Unsupported if Warp finds no such device."""
    with quiet():  # Warp prints that the CUDA driver is missing
        import warp

        warp.config.log_level = warp.LOG_ERROR
        warp.init()
        try:
            warp.get_device(device)
        except (RuntimeError, ValueError):
            raise Unsupported(f"Warp finds no device {device!r} here") from None
    return warp


class WarpModel:
    def __init__(self, model: MuJoCoModel, tolerance: float) -> None:
        """tolerance: tolerance in the settings; in `model` it is scaled by the inertia without drives."""
        self.model, self.device = model, chosen_device()
        self.warp = load_warp(self.device)
        with quiet():
            import mujoco_warp
        self.mujoco_warp = mujoco_warp
        with self.warp.ScopedDevice(self.device):
            self.start = model.start()
            self.held = self.mujoco_warp.put_model(model.compiled)
            share = model.compiled.opt.tolerance / tolerance if tolerance else 1.0
            self.held.opt.tolerance.fill_(share * max(tolerance, LEAST_TOLERANCE))
        self.size = size_of(model, self.start.nefc)

    def _data(self) -> Any:
        return self.mujoco_warp.put_data(self.model.compiled, self.start)

    def record(self, samples: int, every: int) -> Recorded:
        with quiet(), self.warp.ScopedDevice(self.device):
            return self._record(samples, every)

    def _record(self, samples: int, every: int) -> Recorded:
        warp, step = self.warp, self.mujoco_warp.step
        step(self.held, self._data())  # this step compiles or loads the kernels
        data = self._data()
        with warp.ScopedCapture() as capture:
            step(self.held, data)

        def advance(count: int) -> None:
            for _ in range(count):
                warp.capture_launch(capture.graph)

        position, velocity, acceleration = np.full((3, samples + 1, self.model.compiled.nq), np.nan)

        def add_state(sample: int) -> None:
            position[sample], velocity[sample] = data.qpos.numpy()[0], data.qvel.numpy()[0]

        stepping = sampled([every] * samples, advance, add_state)
        for sample in range(samples + 1):
            acceleration[sample] = self._acceleration(data, position[sample], velocity[sample])
        motion = self.model.tree.motion(*(v[:, self.model.address] for v in (position, velocity, acceleration)))
        warnings = (LATE_VELOCITY_TERM,) if self.model.tree.loops else ()
        return Recorded(*motion, stepping, *self.model.inertias_and_gravity(), warnings)

    def _acceleration(self, data: Any, position: Array, velocity: Array) -> Array:
        if not (np.isfinite(position).all() and np.isfinite(velocity).all()):
            return np.full_like(position, np.nan)
        data.qpos.assign(position[None].astype(np.float32))
        data.qvel.assign(velocity[None].astype(np.float32))
        for _ in range(2):  # The first evaluation computes velocities for the second one.
            data.qacc_warmstart.zero_()  # In single precision the solver's result depends on its initial guess.
            self.mujoco_warp.forward(self.held, data)
        return data.qacc.numpy()[0].astype(np.float64)


DEFAULT = MuJoCoWarp("default")
TUNED = MuJoCoWarp("tuned", replace(C_TUNED, stiffness=StiffInSinglePrecision()))
VARIANTS = (DEFAULT, TUNED)


def run_worlds(engine: MuJoCoWarp, mechanisms: Sequence[Mechanism], dt: float, steps: int) -> tuple[Array, float]:
    """The poses (worlds, bodies, 3) after these steps of mechanisms of one structure, and the elapsed time [s].

    One graph steps all worlds. The time excludes building and compilation.
    """
    models = [engine.compiled(mechanism, dt) for mechanism in mechanisms]
    first = WarpModel(models[0], engine.settings.tolerance)
    warp, held = first.warp, first.held
    with quiet(), warp.ScopedDevice(first.device):
        for name, array in list(vars(held).items()):
            if not isinstance(array, warp.array) or array.ndim < 2 or not hasattr(models[0].compiled, name):
                continue
            values = np.stack([np.asarray(getattr(model.compiled, name), dtype=np.float32) for model in models])
            if array.shape[0] == 1 and np.any(values != values[0]):
                setattr(
                    held, name, warp.array(values.reshape(len(models), *array.numpy().shape[1:]), dtype=array.dtype)
                )
        data = first.mujoco_warp.put_data(models[0].compiled, first.start, nworld=len(models))
        rates = np.stack([model.start().qvel for model in models]).astype(np.float32)
        data.qvel.assign(rates)
        first.mujoco_warp.step(held, data)  # compiles or loads the kernels
        data.qpos.zero_()
        data.qvel.assign(rates)
        with warp.ScopedCapture() as capture:
            first.mujoco_warp.step(held, data)
        begin = time.perf_counter()
        for _ in range(steps):
            warp.capture_launch(capture.graph)
        warp.synchronize()
        elapsed = time.perf_counter() - begin
        place, rest = data.qpos.numpy().astype(float), np.zeros(models[0].compiled.nq)
    poses = [model.tree.instant(at[model.address], rest)[0] for model, at in zip(models, place, strict=True)]
    return np.array(poses), elapsed
