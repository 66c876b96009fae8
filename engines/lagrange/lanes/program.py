"""The program that steps mechanisms with equal joints; each vector contains LANES mechanisms.

The equations are those of the folder `compiled`. The program has no branches except for the number of Newton iterations
and for small pivots. A mechanism whose smallest pivot is below LEAST_PIVOT must be repeated alone.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import llvmlite.binding as llvm
import numpy as np
from llvmlite import ir
from numpy.typing import NDArray

from engines.lagrange.compiled.solve import WELL_CONDITIONED
from engines.lagrange.dynamics import PROJECTION_ITERATIONS
from engines.lagrange.lanes.code import COUNT, POINTER, Code, Places
from engines.lagrange.lanes.number import LANES, REAL, VECTOR, Number, equations, largest, least
from engines.lagrange.methods import Tableau
from engines.lagrange.records import CLOSED, Records, RowSelection, System
from engines.lagrange.system import Key

Array = NDArray[np.float64]

# A mechanism with a smaller pivot is repeated alone. With two corrections, the error that an older factor causes in
# velocities is then below rounding.
LEAST_PIVOT = 1e-6
CAREFUL_CORRECTIONS = 2
TABLES = ("bodies", "joints", "forces", "terms", "rows", "equations", "ends", "further_ends", "products")
LISTS = ("matrix", "inverse_pivots", "right", "reaction", "residual", "change")


class VectorProgram:
    """The program of mechanisms that differ in the numbers `varied`, each with its place in the parameters.

    projects: whether to project after each step.
    """

    def __init__(self, system: System, varied: Mapping[Key, int], tableau: Tableau, projects: bool) -> None:
        self.system, self.varied, self.tableau = system, varied, tableau
        self.moving, self.stages = len(system.change) - 3, max(1, len(tableau.nodes))
        self.module, self.places = ir.Module("lanes"), Places()
        for name in ("pose", "twist", "stage_pose", "stage_twist"):
            self.places.reserve(name, self.moving)
        for name in ("velocities", "accelerations"):
            self.places.reserve(name, self.stages * self.moving)
        for name in ("matrix", "inverse_pivots"):
            self.places.reserve(name, len(getattr(system, name)))
        for name in ("time", "pivot", "factor_pivot", "open"):
            self.places.reserve(name, 1)
        self.factor: Any = None
        self.projection = self._projection() if len(system.rows) > 0 else None
        self._run(self._step(projects))

    def _code(self, name: str, *further: ir.Type, result: ir.Type | None = None) -> Code:
        return Code(self.module, self.places, name, *further, result=result)

    def _traced(self, code: Code) -> SimpleNamespace:
        """The system with `Number`s for the varied numbers."""
        slots = {key: code.load(code.parameters, slot) for key, slot in self.varied.items()}

        def records(name: str, table: Records) -> list[SimpleNamespace]:
            fields = table.dtype.names or ()
            return [
                SimpleNamespace(**{f: slots.get((name, i, f), value) for f, value in zip(fields, row, strict=True)})
                for i, row in enumerate(table.tolist())
            ]

        system = self.system
        tables = {name: records(name, getattr(system, name)) for name in TABLES}
        (constants,) = records("constants", system.constants.reshape(1))
        (status,) = records("status", system.status.reshape(1))
        lists = {name: [0.0] * len(getattr(system, name)) for name in LISTS}
        return SimpleNamespace(**tables, **lists, constants=constants, status=status, columns=system.columns.tolist())

    def _acceleration(self, corrections: int = 0, careful: Code | None = None) -> Code:
        """A function that computes the accelerations in a stage; its argument is their place.

        careful: the function for small pivots, whose results replace those of this function.
        """
        code = self._code(f"accelerate_{corrections}", POINTER)
        system, out = self._traced(code), [0.0] * (self.moving + 3)
        pose, twist = (code.vectors(name) + [0.0] * 3 for name in ("stage_pose", "stage_twist"))
        equations(corrections)["accelerate"](system, pose, twist, code.vectors("time")[0], out)
        pivot = system.status.factor_pivot if system.rows else 1.0
        for k, value in enumerate(out[:-3]):
            if careful is None and corrections:
                earlier = code.load(code.arguments[0], k)
                value = pivot.chosen("<", WELL_CONDITIONED, value, earlier) if isinstance(pivot, Number) else value
            code.store(value, code.arguments[0], k)
        self._end(code, pivot, careful, *code.arguments)
        return code

    def _end(self, code: Code, pivot: Any, careful: Code | None, *arguments: ir.Value) -> None:
        """End a function, with a call of `careful` if the pivot of a mechanism is small."""
        code.put([least(code.vectors("pivot")[0], pivot)], "pivot")
        if careful is not None and isinstance(pivot, Number):
            with code.builder.if_then(code.is_any(pivot, WELL_CONDITIONED), likely=False):
                code.call(careful, *arguments)
        code.builder.ret_void()

    def _projection(self) -> Code:
        """A function that moves the pose and twist to the nearest values that satisfy the joints."""
        holonomic_rows, rows = int(self.system.constants["holonomic_rows"]), len(self.system.rows)
        newton = self._newton(holonomic_rows == rows) if holonomic_rows else None
        careful = self._twist_projection(CAREFUL_CORRECTIONS, None)
        twist = self._twist_projection(0, careful, self.factor if holonomic_rows == rows else None)
        code = self._code("project")
        if newton is not None:
            code.put([1.0], "open")
            before, body = code.builder.block, code.builder.append_basic_block()
            code.builder.branch(body)
            code.builder.position_at_end(body)
            done = code.builder.phi(COUNT)
            done.add_incoming(COUNT(0), before)
            is_open = code.call(newton)
            following, after = code.builder.add(done, COUNT(1)), code.builder.append_basic_block()
            done.add_incoming(following, body)
            is_allowed = code.builder.icmp_signed("<", following, COUNT(PROJECTION_ITERATIONS))
            code.builder.cbranch(code.builder.and_(is_open, is_allowed), body, after)
            code.builder.position_at_end(after)
            (open_now,), (pivot,) = code.vectors("open"), code.vectors("pivot")
            code.put([open_now.chosen(">", 0.5, -1.0, pivot)], "pivot")
        code.call(twist)
        code.builder.ret_void()
        return code

    def _newton(self, has_holonomic_rows_only: bool) -> Code:
        """A function that makes an iteration for open joints, and returns whether joints of a mechanism are open."""
        code = self._code("newton", result=ir.IntType(1))
        system, call = self._traced(code), equations(0)
        pose, twist = (code.vectors(name) + [0.0] * 3 for name in ("pose", "twist"))
        call["set_bodies"](system.bodies, pose, twist)
        call["set_equations"](system, code.vectors("time")[0])
        system.right = [-equation.gap for equation in system.equations]
        system.status.selection = RowSelection.ALL if has_holonomic_rows_only else RowSelection.HOLONOMIC
        call["factorise_rows"](system)
        call["solve"](system, 0)
        (is_open,) = code.vectors("open")
        furthest: Any = 0.0
        for k, change in enumerate(system.change[: self.moving]):
            furthest = largest(furthest, abs(change) * (1.0 if k % 3 == 2 else system.constants.inverse_length))
            pose[k] = pose[k] + is_open.chosen(">", 0.5, change, 0.0)
        code.put(pose, "pose")
        is_open = is_open.chosen("<", 0.5, 0.0, furthest.chosen(">", CLOSED, 1.0, 0.0))
        pivot = system.status.factor_pivot
        code.put([is_open], "open")
        code.put([least(code.vectors("pivot")[0], pivot)], "pivot")
        self.factor = system.matrix, system.inverse_pivots, pivot
        for name, values in zip(("matrix", "inverse_pivots"), self.factor, strict=False):
            code.put(values, name)
        code.put([pivot], "factor_pivot")
        code.builder.ret(code.is_any(-is_open, -0.5))
        return code

    def _twist_projection(self, corrections: int, careful: Code | None, factor: Any = None) -> Code:
        """A function that removes the slips, with the factor of the last iteration unless `factor` is None."""
        code = self._code(f"project_twist_{corrections}")
        system, call = self._traced(code), equations(corrections)
        pose, twist = (code.vectors(name) + [0.0] * 3 for name in ("pose", "twist"))
        call["set_bodies"](system.bodies, pose, twist)
        call["set_equations"](system, code.vectors("time")[0])
        slips = [call["row_times"](system, row, twist) for row in range(len(system.rows))]
        system.right = [equation.rate - slip for equation, slip in zip(system.equations, slips, strict=True)]
        system.status.selection = RowSelection.ALL
        if factor is None:
            call["factorise_rows"](system)
            call["solve"](system, 0)
        else:
            names = ("matrix", "inverse_pivots")
            system.matrix, system.inverse_pivots = (
                [new if isinstance(old, Number) else old for old, new in zip(olds, code.vectors(name), strict=True)]
                for name, olds in zip(names, factor, strict=False)
            )
            system.status.factor_pivot = code.vectors("factor_pivot")[0]
            call["solve"](system, 1)
        code.put([value + change for value, change in zip(twist, system.change, strict=True)], "twist")
        self._end(code, system.status.factor_pivot, careful)
        return code

    def _step(self, projects: bool) -> Code:
        """A function that makes a step from a time [s]; its arguments are the time and the step."""
        accelerate = self._acceleration(0, self._acceleration(CAREFUL_CORRECTIONS))
        code = self._code("step", REAL, REAL)
        t, dt = (code.splat(argument) for argument in code.arguments)
        if not len(self.tableau.nodes):
            self._stage(code, accelerate, 0, t, dt)
            self._add(code, [1.0], dt, "stage_twist", "accelerations", "twist")
            with code.loop(self.moving) as k:
                twist = code.load(code.work, code.moved("twist", k))
                pose = code.load(code.work, code.moved("pose", k))
                code.store(pose + dt * twist, code.work, code.moved("pose", k))
        else:
            for stage, node in enumerate(self.tableau.nodes.tolist()):
                self._stage(code, accelerate, stage, t + node * dt, dt)
            for name, rates in (("pose", "velocities"), ("twist", "accelerations")):
                self._add(code, self.tableau.weights.tolist(), dt, name, rates, name)
        if self.projection is not None and projects:
            code.put([t + dt], "time")
            code.call(self.projection)
        code.builder.ret_void()
        return code

    def _stage(self, code: Code, accelerate: Code, stage: int, t: Number, dt: Number) -> None:
        shares = self.tableau.stages[stage, :stage].tolist() if stage else []
        self._add(code, shares, dt, "pose", "velocities", "stage_pose")
        self._add(code, shares, dt, "twist", "accelerations", "stage_twist")
        with code.loop(self.moving) as k:
            twist = code.load(code.work, code.moved("stage_twist", k))
            place = code.builder.add(k, COUNT(stage * self.moving))
            code.store(twist, code.work, code.moved("velocities", place))
        code.put([t], "time")
        begin = COUNT(self.places["accelerations"][0] + stage * self.moving)
        code.call(accelerate, code.builder.gep(code.work, [begin], source_etype=VECTOR))

    def _add(self, code: Code, weights: list[float], dt: Number, begin: str, rates: str, to: str) -> None:
        """Set the array `to` to `begin` plus the weighted sum of the stages' rates times the step."""
        with code.loop(self.moving) as k:
            total: Any = 0.0
            for stage, weight in enumerate(weights):
                place = code.builder.add(k, COUNT(stage * self.moving))
                total = total + weight * code.load(code.work, code.moved(rates, place)) if weight else total
            start = code.load(code.work, code.moved(begin, k))
            code.store(start + dt * total, code.work, code.moved(to, k))

    def _run(self, step: Code) -> None:
        """The function that fills the samples of all blocks of LANES mechanisms.

        Arguments after the parameters: poses, twists (blocks, samples + 1, coordinates, LANES) and smallest pivots
        (blocks, LANES); the numbers of blocks, samples and steps per sample, and the step [s]; whether to project the
        start.
        """
        code = self._code("run", POINTER, POINTER, POINTER, COUNT, COUNT, COUNT, REAL, COUNT)
        poses, twists, pivots, blocks, samples, every, dt, is_start_moved = code.arguments
        builder, states = code.builder, (("pose", poses), ("twist", twists))

        def copy(sample: ir.Value, reads: bool) -> None:
            with code.loop(self.moving) as k:
                place = builder.add(builder.mul(sample, COUNT(self.moving)), k)
                for name, array in states:
                    if reads:
                        code.store(code.load(array, place), code.work, code.moved(name, k))
                    else:
                        code.store(code.load(code.work, code.moved(name, k)), array, place)

        with code.loop(blocks) as block:
            begin = builder.mul(block, COUNT(len(self.varied)))
            parameters = builder.gep(code.parameters, [begin], source_etype=VECTOR)
            first = builder.mul(block, builder.add(samples, COUNT(1)))
            copy(first, reads=True)
            code.put([1.0], "pivot")
            if self.projection is not None:
                with builder.if_then(builder.icmp_signed("!=", is_start_moved, COUNT(0))):
                    code.put([0.0], "time")
                    code.call(self.projection, parameters=parameters)
                    copy(first, reads=False)
            with code.loop(samples) as sample:
                with code.loop(every) as number:
                    steps = builder.add(builder.mul(sample, every), number)
                    t = builder.fmul(builder.sitofp(steps, REAL), dt)
                    code.call(step, t, dt, parameters=parameters)
                copy(builder.add(first, builder.add(sample, COUNT(1))), reads=False)
            code.store(code.vectors("pivot")[0], pivots, block)
        builder.ret_void()


class MachineCode:
    """The compiled program; calls do not hold Python's lock."""

    def __init__(self, program: VectorProgram) -> None:
        llvm.initialize_native_target()
        llvm.initialize_native_asmprinter()
        module = llvm.parse_assembly(str(program.module))
        features = llvm.get_host_cpu_features().flatten()
        machine = llvm.Target.from_default_triple().create_target_machine(
            cpu=llvm.get_host_cpu_name(), features=features, opt=2, jit=True
        )
        builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
        builder.getModulePassManager().run(module, builder)
        self._engine = llvm.create_mcjit_compiler(module, machine)
        self._engine.finalize_object()
        pointer, count = ctypes.c_void_p, ctypes.c_int64
        kinds = (*[pointer] * 5, *[count] * 3, ctypes.c_double, count)
        self._function = ctypes.CFUNCTYPE(None, *kinds)(self._engine.get_function_address("run"))
        self._size = program.places.size

    def run(self, parameters: Array, poses: Array, twists: Array, every: int, dt: float, moves_start: bool) -> Array:
        """Fill the samples after the first; return the smallest pivots (mechanisms,), which are -1 for open joints.

        parameters (mechanisms, n); poses, twists (mechanisms, samples + 1, bodies, 3). The start is also set if
        `moves_start`.
        """
        count, states = poses.shape[:2]
        blocks = -(-count // LANES)
        lanes = np.minimum(np.arange(blocks * LANES), count - 1).reshape(blocks, LANES)
        numbers = np.ascontiguousarray(np.swapaxes(parameters[lanes], 1, 2))
        starts = [array[:, 0].reshape(count, -1)[lanes] for array in (poses, twists)]
        samples = np.empty((2, blocks, states, starts[0].shape[2], LANES))
        samples[:, :, 0] = np.swapaxes(starts, 2, 3)
        pivots = np.empty((blocks, LANES))
        work = np.empty((self._size + 1) * LANES)
        aligned = work.ctypes.data + (-work.ctypes.data) % (8 * LANES)
        addresses = (array.ctypes.data for array in (numbers, samples[0], samples[1], pivots))
        self._function(aligned, *addresses, blocks, states - 1, every, dt, moves_start)
        for array, filled in zip((poses, twists), samples, strict=True):
            array[:] = np.moveaxis(filled, 3, 1).reshape(blocks * LANES, *poses.shape[1:])[:count]
        return pivots.reshape(-1)[:count]
