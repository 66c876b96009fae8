"""MuJoCo as an engine under test: planar joints as a tree, and loops as soft equality constraints."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from engines.mujoco.engine import MuJoCo, bare_loop
from engines.mujoco.methods import DEFAULT, DRIVES, EXTENDED, METHODS, TUNED, VARIANTS
from engines.mujoco.stiffness import Hardened, Shipped, TiedToStep


def read(model: Any, data: Any = None, without: Sequence[str] = ()) -> Any:
    """A mujoco.MjModel as a mechanism of the plane: see `engines.mujoco.reading.read`."""
    # Imported by name: the reading of models is not a dependency of the rows of an engine.
    return import_module("engines.mujoco.reading").read(model, data, without)


__all__ = [
    "DEFAULT",
    "DRIVES",
    "EXTENDED",
    "METHODS",
    "TUNED",
    "VARIANTS",
    "Hardened",
    "MuJoCo",
    "Shipped",
    "TiedToStep",
    "bare_loop",
    "read",
]
