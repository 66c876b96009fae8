"""Who holds a mechanism's joints in a method, in a few words: a reader must not take our rows for an engine's own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from enum import StrEnum
from functools import cache

from engines import Engine, Holder
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.model.cells import Cell, mechanism_of
from reports.model.measure import Measurement

NOTHING_HELD = "no joints"


class Column(StrEnum):
    """The columns of a table of engines, and what stands in none."""

    SHIPPED = "as shipped"
    SETTINGS = "documented settings"
    CODE = "with our code"
    NAIVE = "naive"  # our code alone holds a joint that the engine does not have
    WHOLE = ""  # of an engine that has no such variants


VARIANTS = {"default": Column.SHIPPED, "tuned": Column.SETTINGS, "extended": Column.CODE}


@cache
def column_of(scene: Scene, engine: Engine) -> Column:
    """Where a method stands for a scene; one that is neither as shipped nor extended has settings."""
    mechanism = mechanism_of(scene)
    held = {engine.holder(joint, mechanism) for joint in mechanism.joints}
    if "ours" in held:
        return Column.NAIVE
    if "engine, our rows" in held or len(engine.steps_of_runs(mechanism)) > 1:
        return Column.CODE
    return VARIANTS.get(engine.variant, Column.SETTINGS)


def told_variant(scene: Scene, engine: Engine) -> str:
    """The variant as a page names it: an engine's usual name is not lent to a trick of a user's; no two share one."""
    if engine.variant not in VARIANTS or column_of(scene, engine) is not Column.NAIVE:
        return engine.variant
    return str(Column.NAIVE) if engine.variant == "default" else f"{Column.NAIVE}, {engine.variant}"


def told_rows(rows: Mapping[Cell, Measurement]) -> dict[Cell, Measurement]:
    """Rows under the variants that pages name."""
    return {cell: replace(row, variant=told_variant(cell.scene, cell.engine)) for cell, row in rows.items()}


def held_by(engine: Engine, mechanism: Mechanism) -> str:
    """'engine', 'ours', or 'engine; skate: ours' where joints are held by different ones.

    Joints are named by kind; where those of one kind differ, by their own names.
    """
    found: dict[Holder, list[str]] = {}
    kinds: dict[str, set[Holder]] = {}
    holders: list[Holder] = [engine.holder(joint, mechanism) for joint in mechanism.joints]
    for joint, holder in zip(mechanism.joints, holders, strict=True):
        kinds.setdefault(_kind(joint), set()).add(holder)
        found.setdefault(holder, [])
    if len(found) <= 1:
        return next(iter(found), NOTHING_HELD)
    for joint, holder in zip(mechanism.joints, holders, strict=True):
        name = _kind(joint) if len(kinds[_kind(joint)]) == 1 else joint.name
        if name not in found[holder]:
            found[holder].append(name)
    others = [f"{' and '.join(names)}: {holder}" for holder, names in sorted(found.items()) if holder != "engine"]
    return "; ".join(["engine", *others] if "engine" in found else others)


def _kind(joint: object) -> str:
    return type(joint).__name__.lower()


@cache
def held_in(scene: Scene, engine: Engine) -> str:
    """Who holds a scene's joints; kept, because a method asks its whole model about each of a hundred joints."""
    return held_by(engine, mechanism_of(scene))


def holders(cells: Iterable[Cell]) -> dict[str, str]:
    """Who holds the joints in these cells, by method; several answers where the cells of a method differ."""
    found: dict[str, dict[str, None]] = {}
    for cell in cells:
        method = f"{cell.engine.name} {told_variant(cell.scene, cell.engine)}"
        found.setdefault(method, {}).setdefault(held_in(cell.scene, cell.engine))
    return {method: " or ".join(told) for method, told in found.items()}
