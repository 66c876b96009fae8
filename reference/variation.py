"""A scene with other numbers, under a name that says which: `free_four_bar crank=0.5 rate=3`."""

from __future__ import annotations

import ast
import difflib
import typing
from collections.abc import Mapping
from dataclasses import MISSING, fields, replace
from typing import Any

from reference.checks import InvalidMechanism, refusal
from reference.kinds import NOT_TAKEN, kind_of
from reference.scene import Scene


def with_settings(scene: Scene, settings: Mapping[str, str]) -> Scene:
    """The scene with fields set by their names, each value a text as it is typed: 0.5, (0, -9.81), True.

    Fields that get the value they have already are not set, and a scene with none is the scene itself. Raises
    InvalidMechanism, in a sentence: for a name that is no field, with the nearest one; for a value that the field does
    not take; for numbers that make no mechanism.
    """
    known = [field.name for field in fields(scene)]  # type: ignore[arg-type]
    hints = typing.get_type_hints(type(scene), include_extras=True)
    values: dict[str, Any] = {}
    for name, text in settings.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, 1, 0.0)
            raise InvalidMechanism(
                f"{scene.name} has no number called {name!r}; did you mean {near[0]!r}? There are {', '.join(known)}"
            )
        kind = kind_of(hints[name])
        taken = next((value for each in _readings(text) if (value := kind.take(each)) is not NOT_TAKEN), NOT_TAKEN)
        if taken is NOT_TAKEN:
            raise refusal(scene.name, name, _readings(text)[0], kind.words)
        if taken != getattr(scene, name):
            values[name] = taken
    if not values:
        return scene
    name = _name(scene.name, {name: values[name] for name in known if name in values})
    changed = named(_replaced(scene, values), name)
    changed.mechanism()  # raises for numbers that are valid each and no mechanism together
    return changed


def told_apart(scenes: tuple[Scene, ...]) -> tuple[Scene, ...]:
    """The scenes, those of one class and name called after the numbers in which they differ from its defaults."""
    names = [scene.name for scene in scenes]
    return tuple(
        named(_replaced(scene, {}), _name(scene.name, _set(scene)))
        if names.count(scene.name) > 1 and _set(scene)
        else scene
        for scene in scenes
    )


def named(scene: Scene, name: str) -> Scene:
    """The same object, called so. Its numbers decide whether two scenes are equal, as with any dataclass."""
    object.__setattr__(scene, "name", name)
    return scene


def _replaced(scene: Scene, values: Mapping[str, Any]) -> Scene:
    return replace(scene, **values)  # type: ignore[type-var]


def _readings(text: str) -> list[Any]:
    """What a text may stand for: a value as Python writes it, or the text itself."""
    try:
        return [ast.literal_eval(text.strip()), text]
    except (ValueError, SyntaxError, MemoryError, RecursionError):
        return [text]


def _set(scene: Scene) -> dict[str, Any]:
    """The fields whose values are not their class's defaults."""
    defaults = {field.name: field.default for field in fields(scene)}  # type: ignore[arg-type]
    return {
        name: getattr(scene, name)
        for name, default in defaults.items()
        if default is MISSING or getattr(scene, name) != default
    }


def _name(base: str, values: Mapping[str, Any]) -> str:
    return " ".join([base, *(f"{name}={_short(value)}" for name, value in values.items())])


def _short(value: Any) -> str:
    """A value with all its digits, in few letters and without blanks."""
    if isinstance(value, tuple):
        return f"({','.join(map(_short, value))})"
    text = repr(value) if not isinstance(value, str) else value
    return "".join(text.removesuffix(".0").split())
