"""MuJoCo's model of a mechanism as text, with all that our adapter changes in it once it is compiled."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from engines import Unsupported
from engines.mujoco import MuJoCo
from engines.mujoco.model import Model
from reference.mechanism import Mechanism

PARTS = ("", "opt", "stat")
OWN = ("opt.timestep",)  # set by the page


@dataclass(frozen=True)
class Text:
    """A model for the page: MJCF; changes to what is compiled of it, by path; its start; where our bodies are in it."""

    text: str
    changes: tuple[tuple[str, tuple[float, ...]], ...]
    velocity: tuple[float, ...]  # qvel at the start
    bodies: tuple[int, ...]  # MuJoCo's number of each body of the mechanism
    turns: tuple[tuple[int, ...], ...]  # for each body: the places in qpos whose sum is its rotation since the start
    springs: bool  # whether solref and solimp act on anything


def text_of(engine: MuJoCo, mechanism: Mechanism, step: float) -> Text:
    """The model of this method; for a step [s], since how deep a skate stands in the ground depends on it.

    Raises Unsupported where our code helps while it is stepped: the page has none.
    """
    model = engine.model(mechanism, step, as_text=True)
    hooks = model.hooks
    if hooks.control or hooks.before or model.drive == "overwrite":
        raise Unsupported("this method rewrites rows in each step by code of ours in Python, which the page has not")
    if model.compiled.nu:
        raise Unsupported("the page sets no actuators")
    assert model.written_as is not None
    text = model.written_as.text()
    start = model.start()
    return Text(
        text,
        tuple(changes(mujoco.MjModel.from_xml_string(text), model.compiled)),
        tuple(start.qvel.tolist()),
        tuple(int(model.compiled.body(f"body {number}").id) for number in range(len(mechanism.bodies))),
        turns(model),
        bool(model.compiled.neq or model.compiled.npair),
    )


def changes(plain: Any, changed: Any) -> list[tuple[str, tuple[float, ...]]]:
    """The numbers of a compiled model that differ from those of another, by path, such as ("opt.gravity", ...)."""
    found = []
    for part in PARTS:
        first, second = (getattr(model, part) if part else model for model in (plain, changed))
        for name in dir(first):
            path = f"{part}.{name}".strip(".")
            if name.startswith("_") or path in OWN:
                continue
            before, after = getattr(first, name), getattr(second, name)
            if not isinstance(before, int | float | np.ndarray):
                continue
            if not np.array_equal(before, after):
                found.append((path, tuple(np.asarray(after, dtype=float).ravel().tolist())))
    return found


def turns(model: Model) -> tuple[tuple[int, ...], ...]:
    """For each body the places in qpos of the rotations from the ground to it."""
    found: dict[int, tuple[int, ...]] = {}
    for link in model.tree.links:  # parents first
        own = () if link.rotation is None else (model.address[link.rotation],)
        found[link.body] = (() if link.parent is None else found[link.parent]) + own
    return tuple(found[number] for number in range(len(found)))
