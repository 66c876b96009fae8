"""A case as a script that needs the engine's package alone, with the numbers that it should print: for its authors."""

from __future__ import annotations

import importlib
import inspect
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from engines import Engine, Unsupported, bullet
from engines.box2d import Box2D
from engines.bullet import Bullet
from engines.exudyn import Exudyn
from engines.lagrange import TRUTH, Lagrange
from engines.mjx import Mjx
from engines.mujoco import MuJoCo
from engines.pinocchio import Model as PinocchioModel
from engines.pinocchio import Pinocchio
from engines.pymunk import Pymunk
from engines.pymunk.written_script import object_lines
from engines.tree import spanning_tree
from reference.forces import Force, Torque
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reports.search import independent, instant_box2d, instant_mujoco, instant_pymunk, motions, raw, raw_law, relations
from reports.search.law import NotAsked, ideal
from reports.search.parts import Recipe
from reports.search.recipe import build
from reports.search.recorded import Recorder, recording, repeated
from reports.search.release import release
from reports.search.subjects import Alone, Subject, at_an_instant

PACKAGES = {Exudyn: "exudyn", Box2D: "pyb2d3", Bullet: "pybullet", Pinocchio: "pinocchio"}
# What a script imports, and how it finds where bodies are, by the engine's name.
BODIES = """

def poses(model, data, start):
    bodies = [model.body(f"body {number}").id for number in range(len(start))]
    turned = [math.atan2(data.xmat[body][3], data.xmat[body][0]) for body in bodies]
    return [(*data.xipos[body][:2], angle + turn) for body, angle, turn in zip(bodies, start, turned)]"""
IMPORTS = {
    "exudyn": "import exudyn\nimport exudyn.itemInterface",
    "box2d": "import pyb2d3",
    "pinocchio": "import pinocchio",
    "pymunk": "import pymunk",
    "mujoco": f"import mujoco{BODIES}",
    "mjx": f"import jax\nimport mujoco\nfrom mujoco import mjx\n\njax.config.update('jax_enable_x64', True){BODIES}",
    "bullet": """import tempfile
from pathlib import Path

import pybullet


def written(text):
    file = Path(tempfile.mkdtemp(), "mechanism.urdf")
    file.write_text(text)
    return str(file)


def places(server, body, start):
    found = {}
    for link in range(pybullet.getNumJoints(body, physicsClientId=server)):
        name = pybullet.getJointInfo(body, link, physicsClientId=server)[1].decode()
        told = pybullet.getLinkState(body, link, computeForwardKinematics=True, physicsClientId=server)
        number = int(name.split()[1])
        found[number] = (*told[0][:2], start[number] + 2 * math.atan2(told[1][2], told[1][3]))
    return [found[number] for number in sorted(found)]""",
}
TURNING = """
    if apart.ndim == 2:  # an angle may be told without its whole turns
        apart[:, 2] = np.remainder(apart[:, 2] + np.pi, 2 * np.pi) - np.pi"""
NAMED, READING = re.compile(r"\bx\d+\b"), re.compile(r"[\w.]+\.[gG]et\w+\(")
IDEAL = """what an independent calculation with exact constraints gives. A method of some order comes nearer with
smaller steps"""
DECLARED = """that of M a = f + J^T F and J a + R F = aref - J' v, by an independent calculation: R and aref are
MuJoCo's own (efc_R, efc_KBIP), and J' v is the term of the velocities"""


def script(subject: Subject, case: Any, check: str, number: int) -> str:
    """The script; empty where our own code takes part while the engine steps, so that the engine alone shows nothing.

    `number` is the case's own, by which one of the relations was asked.
    """
    if isinstance(subject, Alone):
        return of_mujoco_alone(case, subject.release)
    try:
        if check == "velocity" and subject.engine.name == "pymunk":
            return of_pymunk(subject.engine, case)
        if check == "velocity":
            return of_first_step(subject.engine, case)
        if check in ("acceleration", instant_mujoco.WITHOUT):
            return of_mujoco(subject.engine, case, check)
        return of_motion(subject.engine, case, check, number)
    except (Unsupported, NotAsked):
        return ""


@dataclass(frozen=True, eq=False)
class Block:
    """A part of a script that steps one model: a title, lines, and Python for what they found (bodies, 3)."""

    title: str
    lines: Sequence[str]
    read: str
    expected: Any

    def function(self, number: int) -> str:
        body = "\n    ".join(line for each in self.lines for line in each.splitlines())
        return f"def run_{number}():\n    {body}\n    return {self.read}\n"


def of_motion(engine: Engine, recipe: Recipe, check: str, number: int) -> str:
    """Places after a short motion by an engine's own calls and by exact constraints; of two steps, or two descriptions.

    An engine that combines several runs is the one that is stepped: its error then falls with the step as it promises.
    Raises Unsupported where it would need code of ours between its steps.
    """
    mechanism = build(recipe)
    stepped = engine.within(mechanism)
    runs = _described_otherwise(recipe, mechanism, number) if check in (*relations.NAMES, "relations") else []
    if not runs:
        steps = motions.SAMPLES * motions.COARSE
        dt = motions.SPAN * mechanism.time_scale / steps
        runs = [("at this step", mechanism, dt, steps), ("at half of it", mechanism, dt / 2, 2 * steps)]
    if isinstance(stepped, Lagrange):
        return _of_the_judge(stepped, runs)
    return _written(stepped, [_block(stepped, *run) for run in runs], IDEAL, TURNING)


Run = tuple[str, Mechanism, float, int]  # title, mechanism, step [s], steps


def _described_otherwise(recipe: Recipe, mechanism: Mechanism, number: int) -> list[Run]:
    name = relations.NAMES[number % len(relations.NAMES)]
    if name in relations.UNITS:
        longer, heavier = relations.UNITS[name]
        length, mass, time = recipe.decades
        changed = build(replace(recipe, decades=(length + longer, mass + heavier, time)))
    else:
        changed, _ = relations.CHANGES[name](mechanism)
    both = (("as it is", mechanism), (name, changed))
    return [(title, each, relations.STEP * each.time_scale, relations.STEPS) for title, each in both]


def _block(engine: Engine, title: str, mechanism: Mechanism, dt: float, steps: int) -> Block:
    title = f"{title}: {steps} steps of {dt:.6g} s"
    expected = TRUTH.build(mechanism, steps * dt)(1, 1).pose[-1]
    match engine:
        case MuJoCo() | Mjx():
            return Block(title, _mujoco_lines(engine, mechanism, dt, steps), "poses(model, data, start)", expected)
        case Pymunk():
            model = engine.model(mechanism, dt)
            constant = any(isinstance(force, Force | Torque) for force in mechanism.forces)
            if model.aims or model.repairs or engine.leapfrog or constant:
                raise Unsupported("code of ours takes part in every step")
            lines = _pymunk_lines(model, model.space.iterations)
            loop = f"for _ in range({steps}):\n    space.step({dt / model.unit!r})"
            bodies = ", ".join(f"b{number}" for number in range(len(model.bodies)))
            return Block(title, [*lines, loop], f"[(*b.position, b.angle) for b in ({bodies},)]", expected)
        case Pinocchio():
            return _pinocchio_block(engine, mechanism, dt)
    lines, read = _told(engine, mechanism, dt, steps)
    return Block(title, lines, read, expected)


def _told(engine: Engine, mechanism: Mechanism, dt: float, steps: int) -> tuple[list[str], str]:
    """What an adapter tells its package while this many steps are taken, and Python for where bodies then are."""
    package = PACKAGES.get(type(engine))
    if package is None:
        raise Unsupported(f"nothing records what is told to {engine.name}")
    module = bullet.package() if package == "pybullet" else importlib.import_module(package)
    with recording(module, "engines.bullet.package" if package == "pybullet" else "") as recorder:
        run = engine.build(mechanism, dt)
        run(1, steps)
        lines = list(recorder.lines)  # some adapters close what they opened when they are gone
    read = _places(engine, mechanism, recorder)
    return _needed(lines, read), read


def _needed(lines: Sequence[str], read: str) -> list[str]:
    """The lines without what was only read; what nobody asks for has no name."""
    out: list[str] = []
    used = {*NAMED.findall(read)}
    for line in reversed(lines):
        name, _, call = line.partition(" = ")
        if NAMED.fullmatch(name) and name not in used:
            if READING.match(call):
                continue
            line = call
        used |= {*NAMED.findall(line)}
        out.append(line)
    return repeated(out[::-1])


def _places(engine: Engine, mechanism: Mechanism, recorder: Recorder) -> str:
    """Python for the poses (bodies, 3) that an engine's own objects have."""
    match engine:
        case Exudyn():
            unit = 2.0 ** round(math.log2(mechanism.length_scale)) if engine.own_units else 1.0
            (system,), (_, *nodes) = recorder.made["AddSystem"], recorder.made["AddNode"]
            told = f"{system}.GetNodeOutput(node, exudyn.OutputVariableType.Coordinates)"
            start = f"np.array({mechanism.pose.tolist()!r})"
            return f"np.array([{told} for node in [{', '.join(nodes)}]]) * [{unit!r}, {unit!r}, 1.0] + {start}"
        case Box2D():
            bodies = ", ".join(recorder.made["create_dynamic_body"])
            place = "(b.position.x, b.position.y, math.atan2(b.rotation.s, b.rotation.c))"
            return f"[{place} for b in [{bodies}]]"
        case _:
            (server,), (body,) = recorder.made["connect"], recorder.made["loadURDF"]
            return f"places({server}, {body}, {mechanism.pose[:, 2].tolist()!r})"


def _pinocchio_block(engine: Pinocchio, mechanism: Mechanism, dt: float) -> Block:
    """Accelerations of its tree's coordinates at the start: it computes no more, the steps are ours."""
    tree = spanning_tree(mechanism)
    model = PinocchioModel(mechanism, tree, engine.correction)
    if len(model.driven):
        raise Unsupported("the torque that keeps a drive's rate is worked out by our code")
    with recording(importlib.import_module("pinocchio")) as recorder:
        engine.build(mechanism, dt)(1, 1)
    found = recorder.made["constraintDynamics"][0]
    end = next(number for number, line in enumerate(recorder.lines) if line.startswith(f"{found} = "))
    count, rates = tree.coordinates, tree.start_rates()
    where, rest = np.zeros((count + 1, count)), np.vstack([np.zeros((1, count)), np.eye(count)])
    _, _, moved = tree.motion(where, np.tile(rates, (count + 1, 1)), rest)
    law = ideal(mechanism, mechanism.pose, mechanism.twist)
    directions = (moved[1:] - moved[0]).reshape(count, -1).T
    expected = np.empty(count)
    expected[model.address] = np.linalg.lstsq(directions, (law.motion - moved[0]).ravel(), rcond=None)[0]
    lines = _needed(recorder.lines[: end + 1], found)
    return Block("accelerations of coordinates at the start", lines, found, expected)


def of_first_step(engine: Engine, recipe: Recipe) -> str:
    """Box2D's velocities after its first step, and those that its soft joints declare."""
    mechanism = build(recipe)
    box = at_an_instant(engine, mechanism)
    if not isinstance(box, Box2D):
        raise Unsupported(f"nothing is known of the steps of {engine.name}")
    dt = instant_box2d.STEP * mechanism.time_scale
    lines, read = _told(replace(box, substeps=1), mechanism, dt, 1)
    speeds = "(b.linear_velocity.x, b.linear_velocity.y, b.angular_velocity)"
    read = f"[{speeds} for b in {read.partition(' for b in ')[2]}"
    _, law, _ = instant_box2d.first_step(box, mechanism)
    block = Block(f"velocities after a step of {dt:.6g} s", lines, read, law)
    return _written(box, [block], "what its own soft joints declare (b2MakeSoft)")


def _written(engine: Engine | None, blocks: Sequence[Block], law: str, turning: str = "") -> str:
    """The script of these blocks; no engine: MuJoCo alone. `turning`: what is done with differences of angles."""
    runs = "\n\n".join(block.function(number) for number, block in enumerate(blocks))
    told = "\n".join(
        f"    ({block.title!r}, run_{number}, {np.asarray(block.expected).tolist()!r}),"
        for number, block in enumerate(blocks)
    )
    name, version = "mujoco", "mujoco.__version__"
    if engine is not None and engine.name != name:
        name, version = engine.name, f"version({engine.packages[0]!r})"
    return f'''"""{name} against a law. Expected is {law}.

Rows are bodies, columns x [m], y [m] and the angle [rad] or their rates; or there is a number for each coordinate.
Calls are those that an adapter made, with their numbers.
"""

import math
from importlib.metadata import version

import numpy as np
{IMPORTS[name]}

{runs}

print("{name}", {version})
for title, run, expected in (
{told}
):
    found, expected = np.array(run()), np.array(expected)
    apart = found - expected{turning}
    print(title)
    print("found   ", found.tolist())
    print("expected", expected.tolist())
    print("largest difference", np.abs(apart).max())
'''


def _mujoco_lines(engine: Any, mechanism: Mechanism, dt: float, steps: int) -> list[str]:
    method = engine.settings if isinstance(engine, Mjx) else engine
    lines = [*_model_lines(method.text(mechanism, dt)), "mujoco.mj_resetDataKeyframe(model, data, 0)"]
    if isinstance(engine, Mjx):
        lines += ["step, held, data = jax.jit(mjx.step), mjx.put_model(model), mjx.put_data(model, data)"]
        lines += [f"for _ in range({steps}):\n    data = step(held, data)", "data = mjx.get_data(model, data)"]
    else:
        lines += [f"for _ in range({steps}):\n    mujoco.mj_step(model, data)"]
    return [*lines, "mujoco.mj_kinematics(model, data)", f"start = {mechanism.pose[:, 2].tolist()!r}"]


def _model_lines(text: str) -> list[str]:
    """A model of MuJoCo's and its data."""
    return [f'model = mujoco.MjModel.from_xml_string("""\n{text.strip()}\n""")', "data = mujoco.MjData(model)"]


def _of_the_judge(engine: Lagrange, runs: Sequence[Run]) -> str:
    """What it gave, beside another calculation that the script carries along."""
    blocks = []
    for title, each, dt, steps in runs:
        found = engine.build(each, dt)(1, steps).pose[-1]
        rolls = [joint for joint in each.joints if isinstance(joint, Roll)]
        tangents = {roll.name: float(roll.rolling.ground.angle(roll.rolling.ground_arc)) for roll in rolls}
        parts = f"{each.bodies!r}, {each.joints!r}, {each.gravity!r}, {each.forces!r}, {tangents!r}"
        told = f"{title}: {steps} steps of {dt:.6g} s"
        blocks.append(f"    ({told!r}, ({parts}), {found.tolist()!r}, {steps * dt!r}),")
    names = sorted({*re.findall(r"\b([A-Z]\w+)\(", "".join(blocks))})
    told = "\n".join(blocks)
    return f"""{inspect.getsource(independent)}

class Named:
    def __init__(self, **numbers):
        self.__dict__.update(numbers)


{", ".join(names)}, = (type(name, (Named,), {{}}) for name in {names!r})
for title, mechanism, found, seconds in (
{told}
):
    expected = Motion(*mechanism).after(seconds)
    print("lagrange {engine.variant}", title)
    print("found   ", found)
    print("expected", expected.tolist())
    print("largest difference", np.abs(found - expected).max())
"""


def of_mujoco(engine: Any, recipe: Recipe, check: str = "acceleration") -> str:
    """The model as MJCF and its accelerations by MuJoCo or MJX at the two instants that are asked.

    Raises Unsupported where our code helps it step.
    """
    mechanism = build(recipe)
    inner = at_an_instant(engine, mechanism)
    if not isinstance(inner, MuJoCo | Mjx):
        raise Unsupported(f"{inner.name} declares no accelerations")
    method = inner.settings if isinstance(inner, Mjx) else inner
    dt, term = instant_mujoco.STEP * mechanism.time_scale, check != instant_mujoco.WITHOUT
    text, model = method.text(mechanism, dt), method.model(mechanism, dt, unit=1.0)
    run = replace(method, estimates=False).build(mechanism, dt)
    finite = np.isfinite(run(1, instant_mujoco.STEPS).pose).all()
    by_mjx = "jax.jit(mjx.forward)(mjx.put_model(model), mjx.put_data(model, data))"
    read = f"np.array({by_mjx if isinstance(inner, Mjx) else 'data'}.qacc)[{model.address!r}]"
    begin, blocks = [*_model_lines(text), "mujoco.mj_resetDataKeyframe(model, data, 0)"], []
    states = {"at the start": model.start()} | ({f"{instant_mujoco.STEPS} steps later": run.data} if finite else {})
    for title, state in states.items():
        data = instant_mujoco.in_state(model, state)
        here = instant_mujoco.Instant.of(mechanism, model, data, method.softness(mechanism, dt))
        numbers = f"{data.time!r}, {data.qpos.tolist()!r}, {data.qvel.tolist()!r}"
        lines = [f"data.time, data.qpos[:], data.qvel[:] = {numbers}", "mujoco.mj_forward(model, data)"]
        expected = here.accelerations(velocity_term=term)
        blocks.append(Block(f"accelerations {title}", [*begin, *lines], read, expected))
    return _written(inner, blocks, DECLARED if term else f"{DECLARED},\nhere left out for loops and rods, as MJX does")


def of_mujoco_alone(model: raw.Model, other: str = "") -> str:
    """One call of mj_forward, and the accelerations that the constraints ask for; `other`: another release."""
    judge = raw_law.judged(model)
    if other:
        expected = np.array(release(other).asked(model)["expected"])
    else:
        _, expected = raw_law.found_and_expected(model, judge)
    names = ", ".join(f"b{body} {what}" for body, what in raw.coordinates(model))
    lines = [f"data.qvel[:] = {judge.rates.tolist()!r}", "mujoco.mj_forward(model, data)"]
    title = f"accelerations of {names}; expected with the R of MuJoCo {other or mujoco.__version__}"
    return _written(None, [Block(title, [*_model_lines(raw.xml(model)), *lines], "data.qacc", expected)], DECLARED)


def of_pymunk(engine: Any, recipe: Recipe) -> str:
    """The objects before one step, the step, and the velocities that its joints ask for. Raises Unsupported."""
    mechanism = build(recipe)
    engine = engine.within(mechanism)
    dt = instant_pymunk.STEP * mechanism.time_scale
    model = engine.model(mechanism, dt)
    for aim in model.aims:
        aim(dt / model.unit)
    expected = instant_pymunk.first_law(engine, mechanism, dt) * model.unit
    lines = [*_pymunk_lines(model, instant_pymunk.MOST_SWEEPS), f"space.step({dt / model.unit!r})"]
    bodies = ", ".join(f"b{number}" for number in range(len(model.bodies)))
    read = f"[(*body.velocity, body.angular_velocity) for body in ({bodies},)]"
    law = "the nearest, in the metric of the masses, that joints allow in the pose after the step's drift"
    return _written(engine, [Block("velocities after a step", lines, read, expected)], law)


def _pymunk_lines(model: Any, sweeps: int) -> list[str]:
    """A space as it is before its first step. Raises Unsupported for what can't be written."""
    settings = f"space.gravity, space.iterations = {tuple(model.space.gravity)!r}, {sweeps}"
    return ["space = pymunk.Space()", settings, *object_lines(model.space, model.bodies)]
