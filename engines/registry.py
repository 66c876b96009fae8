"""ENGINES: the one list of what is under test. A new engine is its own file and one line here."""

from __future__ import annotations

from engines import Engine, lagrange, mujoco, pymunk

ENGINES: tuple[Engine, ...] = (*pymunk.METHODS, *mujoco.METHODS, *lagrange.METHODS)
