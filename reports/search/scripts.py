"""Scripts for the authors of pymunk, MuJoCo and MJX. A script runs a case with the engine only.

A script prints the engine's result, the expected result and their difference.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from engines import Engine, Unsupported
from engines.lagrange import TRUTH
from engines.mujoco.declared import NO_VELOCITY_TERMS, ROUNDING_TOLERANCE, DeclaredState
from engines.pymunk.declared import LAW_ITERATION_LIMIT, first_law
from engines.pymunk.written_script import object_lines
from reference.forces import Force, Torque
from reference.mechanism import Mechanism
from reports.search import motions, mujoco_alone, relations
from reports.search.law import INSTANT_STEP, INSTANT_STEPS, CheckSkipped
from reports.search.parts import Recipe
from reports.search.recipe import build
from reports.search.release import check_accelerations
from reports.search.subjects import Alone, Subject
from reports.write.templates import environment

SCRIPTED = ("pymunk", "mujoco", "mjx")  # Engines for which scripts are written.
IDEAL_LAW = """the motion with exact constraints. The error of a right method falls with the step"""
DECLARED_LAW = """the solution of M a = f + J^T F and J a + R F = aref - J' v, with R and aref by MuJoCo's efc_R and
efc_KBIP"""
IMPULSE_LAW = """the projection of the velocities onto the joints, in the metric of the masses and in the pose after the
step"""


@dataclass(frozen=True, eq=False)
class Block:
    """A function in a script that steps one model. `read`: expression in Python for the result."""

    title: str
    lines: Sequence[str]
    read: str
    expected: Any


def write_script(subject: Subject, case: Any, check: str, number: int) -> str:
    """The script of a case; empty for other engines, or if our code runs between the steps. `number`: number of the
    case, which selects the relation."""
    if isinstance(subject, Alone):
        return _of_mujoco_alone(case, subject.release)
    mechanism = build(case)
    engine: Any = subject.engine.stepped(mechanism)
    if engine.name not in SCRIPTED:
        return ""
    try:
        if check == "velocity":
            return _of_velocities(engine, mechanism)
        if check in ("acceleration", "reaction", NO_VELOCITY_TERMS):
            return _of_accelerations(engine, mechanism, check)
        blocks = [_motion(engine, *run) for run in _runs(case, mechanism, check, number)]
    except Unsupported:
        return ""
    return _render_script(engine, blocks, IDEAL_LAW, turning=True)


def _runs(recipe: Recipe, mechanism: Mechanism, check: str, number: int) -> list[tuple[str, Mechanism, float, int]]:
    """Two runs (title, mechanism, step [s], number of steps). A relation has two descriptions; other checks have two
    steps."""
    name = relations.RELATIONS[number % len(relations.RELATIONS)]
    if check in (*relations.RELATIONS, "relations"):
        changed = relations.describe_otherwise(mechanism, recipe, name)
        both = [("original", mechanism)] + ([] if isinstance(changed, CheckSkipped) else [(name, changed[0])])
        return [(title, one, INSTANT_STEP * one.time_scale, INSTANT_STEPS) for title, one in both]
    steps = motions.MOTION_SAMPLES * motions.COARSE_STEPS
    dt = motions.MOTION_SPAN * mechanism.time_scale / steps
    return [("full step", mechanism, dt, steps), ("half step", mechanism, dt / 2, 2 * steps)]


def _motion(engine: Any, title: str, mechanism: Mechanism, dt: float, steps: int) -> Block:
    title = f"{title}: {steps} steps of {dt:.6g} s"
    expected = TRUTH.build(mechanism, steps * dt)(1, 1).pose[-1]
    if engine.name != "pymunk":
        return Block(title, _mujoco_lines(engine, mechanism, dt, steps), "poses(model, data, start)", expected)
    model = engine.model(mechanism, dt)
    constant = any(isinstance(force, Force | Torque) for force in mechanism.forces)
    if model.before_step or model.after_step or engine.leapfrog or constant:
        raise Unsupported("our code runs in every step")
    lines = _pymunk_lines(model, model.space.iterations)
    loop = f"for _ in range({steps}):\n    space.step({dt / model.unit!r})"
    return Block(title, [*lines, loop], f"[(*b.position, b.angle) for b in ({_bodies(model)},)]", expected)


def _of_velocities(engine: Any, mechanism: Mechanism) -> str:
    dt = INSTANT_STEP * mechanism.time_scale
    model = engine.model(mechanism, dt)
    for update in model.before_step:
        update(dt / model.unit)
    expected = first_law(engine, mechanism, dt) * model.unit
    lines = [*_pymunk_lines(model, LAW_ITERATION_LIMIT), f"space.step({dt / model.unit!r})"]
    read = f"[(*body.velocity, body.angular_velocity) for body in ({_bodies(model)},)]"
    return _render_script(engine, [Block("velocities after a step", lines, read, expected)], IMPULSE_LAW)


def _of_accelerations(engine: Any, mechanism: Mechanism, check: str) -> str:
    import mujoco

    by_mjx = engine.name == "mjx"
    method = engine.settings if by_mjx else engine
    method = replace(method, tolerance=min(method.tolerance, ROUNDING_TOLERANCE), estimates=False)
    dt, term = INSTANT_STEP * mechanism.time_scale, check != NO_VELOCITY_TERMS
    text, model = method.text(mechanism, dt), method.model(mechanism, dt, unit=1.0)
    run = method.build(mechanism, dt)
    finite = np.isfinite(run(1, INSTANT_STEPS).pose).all()
    answer = "jax.jit(mjx.forward)(mjx.put_model(model), mjx.put_data(model, data))" if by_mjx else "data"
    read = f"np.array({answer}.qacc)[{model.address!r}]"
    begin, blocks = [*_model_lines(text), "mujoco.mj_resetDataKeyframe(model, data, 0)"], []
    states = {"at the start": model.start()} | ({f"{INSTANT_STEPS} steps later": run.data} if finite else {})
    for title, state in states.items():
        data = model.start()
        data.time, data.qpos[:], data.qvel[:] = state.time, state.qpos, state.qvel
        mujoco.mj_forward(model.compiled, data)
        expected = DeclaredState.of(mechanism, model, data, method.regularisation(mechanism, dt)).coordinates(term)
        numbers = f"{data.time!r}, {data.qpos.tolist()!r}, {data.qvel.tolist()!r}"
        lines = [f"data.time, data.qpos[:], data.qvel[:] = {numbers}", "mujoco.mj_forward(model, data)"]
        blocks.append(Block(f"accelerations {title}", [*begin, *lines], read, expected))
    return _render_script(
        engine, blocks, DECLARED_LAW if term else f"{DECLARED_LAW},\nwithout J' v for loops and rods, as in MJX"
    )


def _of_mujoco_alone(model: mujoco_alone.RawModel, other: str) -> str:
    """A script with accelerations by one call of mj_forward. `other`: another release, or ""."""
    rates, accelerations = mujoco_alone.start_equations(model).rates, check_accelerations(model, other)
    names = ", ".join(f"b{body} {coordinate}" for body, coordinate in mujoco_alone.coordinates(model))
    lines = [f"data.qvel[:] = {rates.tolist()!r}", "mujoco.mj_forward(model, data)"]
    title = f"accelerations of {names}; expected with the R of MuJoCo {accelerations['version']}"
    block = Block(title, [*_model_lines(mujoco_alone.to_mjcf(model)), *lines], "data.qacc", accelerations["expected"])
    return _render_script(None, [block], DECLARED_LAW)


def _render_script(engine: Engine | None, blocks: Sequence[Block], law: str, turning: bool = False) -> str:
    """The text of a script. turning: whether angles may differ by whole turns."""
    name, version = "mujoco", "mujoco.__version__"
    if engine is not None and engine.name != name:
        name, version = engine.name, f"version({engine.packages[0]!r})"
    templates = environment(Path(__file__).parent)
    templates.filters["code"] = lambda value: repr(value if isinstance(value, str) else np.asarray(value).tolist())
    template = templates.get_template("own/script.jinja")
    return template.render(name=name, version=version, blocks=blocks, law=law, turning=turning)


def _mujoco_lines(engine: Any, mechanism: Mechanism, dt: float, steps: int) -> list[str]:
    by_mjx = engine.name == "mjx"
    method = engine.settings if by_mjx else engine
    lines = [*_model_lines(method.text(mechanism, dt)), "mujoco.mj_resetDataKeyframe(model, data, 0)"]
    if by_mjx:
        lines += ["step, held, data = jax.jit(mjx.step), mjx.put_model(model), mjx.put_data(model, data)"]
        lines += [f"for _ in range({steps}):\n    data = step(held, data)", "data = mjx.get_data(model, data)"]
    else:
        lines += [f"for _ in range({steps}):\n    mujoco.mj_step(model, data)"]
    return [*lines, "mujoco.mj_kinematics(model, data)", f"start = {mechanism.pose[:, 2].tolist()!r}"]


def _model_lines(text: str) -> list[str]:
    return [f'model = mujoco.MjModel.from_xml_string("""\n{text.strip()}\n""")', "data = mujoco.MjData(model)"]


def _pymunk_lines(model: Any, sweeps: int) -> list[str]:
    settings = f"space.gravity, space.iterations = {tuple(model.space.gravity)!r}, {sweeps}"
    return ["space = pymunk.Space()", settings, *object_lines(model.space, model.bodies)]


def _bodies(model: Any) -> str:
    return ", ".join(f"b{number}" for number in range(len(model.bodies)))
