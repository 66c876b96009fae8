"""MJX under test: MuJoCo's model, stepped by JAX instead of C, here on the processor and in double precision.

Our MuJoCo adapter compiles the MjModel with the same settings, so only the implementation differs from `mujoco`. MJX
cannot call the MuJoCo adapter's callbacks, so models with callbacks are refused. Skates and rolling are refused too:
MJX has contacts, but this adapter builds none. If MJX refuses a model, the adapter passes on MJX's message.

MJX omits the velocity term (dJ/dt) v of loops, which MuJoCo in C has since version 3.7. MJX's tests say "Jdotv effect
(not in MJX)". A loop therefore has a gap of (dJ/dt) v times the square of the row's time constant at any step. Runs
with loops have a warning, and `reports/pages/engines` compares the forces. If the time constant is a multiple of the
step, the error is proportional to the square of the multiple. For the free four-bar (RK4, 1 ms) the error is 7.40e-4
rad with a time constant of two steps, as in MuJoCo before 3.7. With the five steps of our tuned variant it is 4.58e-3
rad.

The solver ends if no residual of the forces exceeds 1e-8, since `mjx.math.norm` then returns zero. The solver's
tolerance then has no effect. The limit of 1e-8 has a unit, so the adapter uses the smallest possible unit of mass
(`_smallest_unit`). With the larger unit of the MuJoCo adapter, a gear would have no effect on light bodies next to
heavy bodies.

The compilation of a model takes 5 to 30 s, which is part of the build time. JAX caches the program for models of the
same structure. The cache is in the user's cache folder, or in the folder that the variable JAX_COMPILATION_CACHE_DIR
names.

The package mujoco-mjx requires the package mujoco, which overwrites the files of mujoco-core with an older release.
Therefore install mujoco-mjx without dependencies: pip install --no-deps mujoco-mjx.
"""

from __future__ import annotations

import math
import os
import platform
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, ClassVar

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.capability import Capability
from engines.contract import ConvergenceOrder, Instant, NotDeclared, Unsupported
from engines.device import chosen_device
from engines.mujoco import declared
from engines.mujoco.methods import TUNED as C_TUNED
from engines.mujoco.model import MuJoCoModel
from engines.mujoco.releases import full_inertia
from engines.mujoco.running import MAX_RESIDUAL, residual_warning
from engines.on_device import MuJoCoOnDevice, size_of, without_contacts
from engines.sampling import sampled
from engines.single_run import Recorded, quiet
from engines.tree import Tree, spanning_tree
from engines.units import power_of_two
from engines.user_cache import cache_folder
from reference.checks import validated
from reference.joints import Rod
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning

Array = NDArray[np.float64]
# Compliance R of the stiffest row at t = 0, relative to mjMINVAL, the smallest R in MuJoCo and MJX. A factor of 2 is a
# margin for a gap of a millimetre, which halves R as shipped. Another factor of 2 is for rounding the unit to a power
# of two.
LEAST_COMPLIANCE = 4.0
NO_VELOCITY_TERM = RunWarning(
    "upstream: loops lack the velocity term J-dot v in MJX, so that they are wrong at any step",
    "known fault",
    "upstream",
)


@dataclass(frozen=True)
class Mjx(MuJoCoOnDevice):
    name = "mjx"
    title: ClassVar[str] = "MJX"
    evaluation_cost: ClassVar[float] = 50e-6
    packages = ("mujoco-mjx", "jax", "mujoco-core")
    modules: ClassVar[tuple[str, ...]] = ("jax", "mujoco.mjx")
    apart: ClassVar[str] = "pip install --no-deps mujoco-mjx"
    capability: ClassVar[Capability] = without_contacts("mjx", "MJX")

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        tree = spanning_tree(mechanism)
        if lacks_velocity_terms(tree):
            return NotDeclared("MJX leaves out the velocity term of loops, which no step makes smaller")
        if tree.closed:  # the rows are sums of angles, which have no velocity terms
            return self.settings.order(mechanism)
        return self.order_without_loops(mechanism)

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """Accelerations in the states of MuJoCo's steps; loops and rods lack their velocity terms."""
        settings = replace(self.settings, tolerance=min(self.settings.tolerance, declared.ROUNDING_TOLERANCE))
        self.capability.require(built or mechanism)
        self.require()
        solved = replace(self, settings=settings).model(built or mechanism, dt)
        check = declared.NO_VELOCITY_TERMS if lacks_velocity_terms(spanning_tree(mechanism)) else "acceleration"

        def accelerations(model: MuJoCoModel, data: Any) -> Array:
            return solved.accelerations(model, data)

        return declared.instants(settings, mechanism, dt, steps, built or mechanism, accelerations, check)

    def stricter(self, mechanism: Mechanism) -> Mjx | None:
        settings = self.settings.stricter(mechanism)
        return None if settings is None else replace(self, settings=settings)

    def model(self, mechanism: Mechanism, dt: float) -> DeviceModel:
        model = self.compiled(mechanism, dt)
        if unit := _smallest_unit(model):
            model = self.compiled(mechanism, dt, unit)
        try:
            return DeviceModel(model)
        except NotImplementedError as reason:
            raise self.refusal(reason) from None
        except (RuntimeError, AssertionError):
            platforms = os.environ.get("JAX_PLATFORMS")
            raise Unsupported(f"JAX finds no device to run on here: JAX_PLATFORMS is {platforms!r}") from None


def _smallest_unit(model: MuJoCoModel) -> float | None:
    """The unit of mass [kg] in which the compliance R of the stiffest row is LEAST_COMPLIANCE * mjMINVAL, or None.

    The solver's limit on forces is then 4e-23 / R [N, with R in 1/kg]. R is at least 1e-4 of the row's inverse inertia.
    So the limit is at most 4e-19 of the inertia times 1 m/s^2 or 1 rad/s^2.
    """
    compliance = model.start().efc_R
    if not len(compliance):
        return None
    return model.unit * power_of_two(LEAST_COMPLIANCE * mujoco.mjMINVAL / float(compliance.min()))


def lacks_velocity_terms(tree: Tree) -> bool:
    """Whether the mechanism has a loop or rod, whose velocity term MJX omits."""
    return bool(tree.loops) or any(isinstance(joint, Rod) for joint in tree.mechanism.joints)


@cache
def _programs() -> tuple[Any, Any, Any]:
    os.environ.setdefault("JAX_PLATFORMS", chosen_device())
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")
    with quiet():  # JAX prints that another backend is missing
        import jax

        jax.config.update("jax_enable_x64", True)
        if "JAX_COMPILATION_CACHE_DIR" not in os.environ:
            # A program has the instructions of one machine, so machines with a shared home use separate folders.
            jax.config.update("jax_compilation_cache_dir", str(cache_folder() / "mjx" / platform.node()))
            jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
        from mujoco import mjx

    def step(model: Any, now: Any) -> Any:
        # In double precision MJX widens some integers of tendon paths, but types must not change within the loop.
        return jax.tree.map(lambda new, old: new.astype(old.dtype), mjx.step(model, now), now)

    def steps(model: Any, data: Any, count: Any) -> Any:
        return jax.lax.fori_loop(0, count, lambda _, now: step(model, now), data)

    return mjx, jax.jit(steps), jax.jit(mjx.forward)


class DeviceModel:
    def __init__(self, model: MuJoCoModel) -> None:
        self.mujoco, (self.mjx, self._steps, self._forward) = model, _programs()
        self._held, self._data = self.mjx.put_model(model.compiled), model.start()
        self.size = size_of(model, self._data.nefc)

    def accelerations(self, model: MuJoCoModel, data: Any) -> Array:
        """MJX's accelerations (nv,) in the state `data`, a mujoco.MjData of `model`.

        The first call for a new structure of a model compiles a program in about 10 s.
        """
        answer = self._forward(self._held, self.mjx.put_data(model.compiled, data))
        return np.asarray(answer.qacc, dtype=np.float64)

    def record(self, samples: int, every: int) -> Recorded:
        model, data = self.mujoco, self._data
        states = [self.mjx.put_data(model.compiled, data)]
        self._steps(self._held, states[0], 0).qpos.block_until_ready()  # compiles
        position, velocity, acceleration = np.full((3, samples + 1, model.compiled.nq), np.nan)

        def record(sample: int) -> None:
            position[sample], velocity[sample] = np.asarray(states[-1].qpos), np.asarray(states[-1].qvel)

        def advance(count: int) -> None:
            states.append(self._steps(self._held, states[-1], count))

        stepping, residual = sampled([every] * samples, advance, record), 0.0
        for sample, state in enumerate(states):
            answer = self._forward(self._held, state)
            acceleration[sample] = np.asarray(answer.qacc)
            if np.isfinite(position[sample]).all() and np.isfinite(acceleration[sample]).all():
                data.time, data.qpos[:], data.qvel[:] = float(state.time), position[sample], velocity[sample]
                residual = max(residual, _solver_residual(model, data, answer))
        motion = model.tree.motion(*(values[:, model.address] for values in (position, velocity, acceleration)))
        warnings = (NO_VELOCITY_TERM,) if lacks_velocity_terms(model.tree) else ()
        if not residual <= MAX_RESIDUAL:
            warnings += (residual_warning(residual),)
        return Recorded(*motion, stepping, *model.inertias_and_gravity(), warnings)


def _solver_residual(model: MuJoCoModel, data: Any, answer: Any) -> float:
    """The residual of MJX's solver in `answer`, as an error relative to the accelerations.

    MJX minimises a quadratic cost. The error is therefore the Newton step H^-1 g, with H = M + J^T R^-1 J and the
    residual g of the forces. `data` is a mujoco.MjData in the same state, which gives the mass matrix M.
    """
    rows, solved = np.asarray(answer._impl.efc_J), np.asarray(answer.qacc)
    if not len(rows):
        return 0.0
    mujoco.mj_forward(model.compiled, data)
    inertia = full_inertia(model.compiled, data)
    hard, aimed = map(np.asarray, (answer._impl.efc_D, answer._impl.efc_aref))
    left = inertia @ solved - np.asarray(answer.qfrc_smooth) + rows.T @ (hard * (rows @ solved - aimed))
    size = max(np.abs(values).max() for values in (solved, np.asarray(answer.qacc_smooth), aimed))
    try:
        return float(np.abs(np.linalg.solve(inertia + (rows.T * hard) @ rows, left)).max() / max(size, 1e-300))
    except np.linalg.LinAlgError:
        return math.inf


def run_worlds(engine: Mjx, mechanisms: Sequence[Mechanism], dt: float, steps: int) -> tuple[Array, float]:
    """The same as `engines.mujoco_warp.run_worlds`; `jax.vmap` maps over the fields that differ between mechanisms."""
    import jax

    jnp = jax.numpy
    models = [engine.compiled(mechanism, dt) for mechanism in mechanisms]
    (mjx, several, _), one = _programs(), DeviceModel(models[0])
    changed = {}
    for name, value in vars(one._held).items():
        if isinstance(value, jax.Array) and hasattr(models[0].compiled, name):
            values = np.stack([np.asarray(getattr(model.compiled, name)) for model in models])
            if np.any(values != values[0]):
                changed[name] = jnp.asarray(values.reshape(len(models), *value.shape), dtype=value.dtype)
    data = mjx.put_data(models[0].compiled, one._data)

    def run(world: dict[str, Any], velocity: Any) -> Any:
        held = one._held.replace(**world)
        return several(held, data.replace(qvel=velocity), steps).qpos

    rates = jnp.asarray(np.stack([model.start().qvel for model in models]))
    program = jax.jit(jax.vmap(run)).lower(changed, rates).compile()
    begin = time.perf_counter()
    place = np.asarray(program(changed, rates))
    elapsed, rest = time.perf_counter() - begin, np.zeros(models[0].compiled.nq)
    poses = [model.tree.instant(at[model.address], rest)[0] for model, at in zip(models, place, strict=True)]
    return np.array(poses), elapsed


DEFAULT = Mjx("default")
TUNED = Mjx("tuned", C_TUNED)
VARIANTS = (DEFAULT, TUNED)
