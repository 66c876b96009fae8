"""A case as a script in the engine's own language, with the numbers that it should print: ready for its authors."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from engines import Unsupported
from engines.mjx import Mjx
from engines.mujoco import MuJoCo
from engines.pymunk import Pymunk
from engines.pymunk.written_script import object_lines
from reports.search import instant_mujoco, instant_pymunk, raw, raw_law
from reports.search.parts import Recipe
from reports.search.recipe import build
from reports.search.release import release
from reports.search.subjects import Adapted, Alone, Subject, at_an_instant

MJX_IMPORTS = """from importlib.metadata import version as version_of

import jax
from mujoco import mjx

jax.config.update("jax_enable_x64", True)
"""
FOUND_BY_MJX = """put = mjx.put_model(model), mjx.put_data(model, data)
found, version = jax.jit(mjx.forward)(*put).qacc, version_of("mujoco-mjx")"""


def script(subject: Subject, case: Any, check: str) -> str:
    """The script; empty where a fault can't be shown without our adapter."""
    if isinstance(subject, Alone):
        return of_mujoco_alone(case, subject.release)
    if isinstance(subject, Adapted) and check == "velocity":
        return of_pymunk(subject.engine, case)
    if isinstance(subject, Adapted) and check == "acceleration":
        return of_mujoco(subject.engine, case)
    return ""


def of_mujoco(engine: Any, recipe: Recipe) -> str:
    """The model as MJCF and its accelerations by MuJoCo or MJX; empty where our code helps while the engine steps."""
    mechanism = build(recipe)
    inner = at_an_instant(engine, mechanism)
    if not isinstance(inner, MuJoCo | Mjx):
        return ""
    method = inner.settings if isinstance(inner, Mjx) else inner
    dt = instant_mujoco.STEP * mechanism.time_scale
    try:
        text, model = method.text(mechanism, dt), method.model(mechanism, dt, as_text=True)
    except Unsupported:
        return ""
    here = instant_mujoco.Instant.of(mechanism, model, model.start(), method.softness(mechanism, dt))
    lines = f"import mujoco\nimport numpy as np\n{MJX_IMPORTS if isinstance(inner, Mjx) else ''}"
    return f'''"""The accelerations of a model at its start, which satisfies every constraint.

Expected: M a = f + J^T F and J a + R F = aref - J' v, where R and aref are MuJoCo's own (efc_R, efc_KBIP) and J' v the
term of the velocities. The numbers of `expected` are those of an independent calculation.
"""

{lines}
MODEL = """
{text.strip()}
"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, 0)
mujoco.mj_forward(model, data)
{FOUND_BY_MJX if isinstance(inner, Mjx) else "found, version = data.qacc, mujoco.__version__"}
expected = np.array({_numbers(here.accelerations())})
found = np.array(found)[{model.address!r}]
print("{"MJX" if isinstance(inner, Mjx) else "MuJoCo"}", version)
print("found   ", found)
print("expected", expected)
print("largest difference", np.abs(found - expected).max())
'''


def of_mujoco_alone(model: raw.Model, other: str = "") -> str:
    """One call of mj_forward, and the accelerations that the constraints ask for; `other`: another release."""
    judge = raw_law.judged(model)
    if other:
        expected = np.array(release(other).asked(model)["expected"])
    else:
        _, expected = raw_law.found_and_expected(model, judge)
    version = other or mujoco.__version__
    names = [f"b{body} {what}" for body, what in raw.coordinates(model)]
    return f'''"""MuJoCo's accelerations in a state that satisfies every constraint.

Expected: M a = f + J^T F and J a + R F = -J' v, where R is MuJoCo's own (efc_R) and J' v the term of the velocities.
The numbers of `expected` are those of an independent calculation, with the R of MuJoCo {version}.
"""

import mujoco
import numpy as np

MODEL = """
{raw.xml(model)}
"""

model = mujoco.MjModel.from_xml_string(MODEL)
data = mujoco.MjData(model)
data.qvel[:] = {_numbers(judge.rates)}
mujoco.mj_forward(model, data)
expected = np.array({_numbers(expected)})
print("MuJoCo", mujoco.__version__, "joints", {names!r})
if mujoco.__version__ != {version!r}:
    print("expected is of MuJoCo {version}, whose constraints may give way otherwise")
print("found   ", data.qacc)
print("expected", expected)
print("largest difference", np.abs(data.qacc - expected).max())
'''


def of_pymunk(engine: Any, recipe: Recipe) -> str:
    """The objects before one step, the step, and the velocities that its joints ask for; empty for other methods."""
    mechanism = build(recipe)
    engine = engine.within(mechanism)
    if not isinstance(engine, Pymunk):
        return ""
    dt = instant_pymunk.STEP * mechanism.time_scale
    model, sweeps = engine.model(mechanism, dt), instant_pymunk.MOST_SWEEPS
    for aim in model.aims:
        aim(dt / model.unit)
    try:
        lines = object_lines(model.space, model.bodies)
    except Unsupported:
        return ""
    expected = instant_pymunk.first_law(engine, mechanism, dt) * model.unit
    body = "\n".join(lines)
    bodies = ", ".join(f"b{number}" for number in range(len(model.bodies)))
    return f'''"""pymunk's velocities after one step.

Expected are the nearest ones, in the metric of the masses, that the joints allow in the pose after the step's drift.
"""

import numpy as np
import pymunk

space = pymunk.Space()
space.gravity, space.iterations = {tuple(model.space.gravity)!r}, {sweeps}
{body}
space.step({dt / model.unit!r})
found = np.array([(*body.velocity, body.angular_velocity) for body in ({bodies},)])
expected = np.array({np.round(expected, 12).tolist()!r})
print("pymunk", pymunk.version)
print("found   ", found.tolist())
print("expected", expected.tolist())
print("largest difference", np.abs(found - expected).max())
'''


def _numbers(values: Any) -> str:
    return "[" + ", ".join(f"{value:.12g}" for value in values) + "]"
