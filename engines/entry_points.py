"""What distributions register under an entry point group, ours first, each found by `engines.loading`.

Ours stand in `pyproject.toml` like those of anybody else. In a checkout that file itself is read: so a clone that was
never installed has them, and one that was installed before the file changed has the present ones.
"""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path
from types import MappingProxyType
from typing import Any

from engines.loading import Kind, load

OURS = "planar-crosscheck"
ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Registered:
    """What a group holds, and a line about each entry point that can't be used; it names the distribution."""

    values: tuple[Any, ...]
    troubles: tuple[str, ...] = ()


def registered(
    group: str,
    kind: Kind,
    name: Callable[[Any], str],
    known: Mapping[str, Any] = MappingProxyType({}),
    extras: bool = False,
) -> Registered:
    """All values of a group, no two of one `name`; of two, ours stays, or that of the first distribution.

    `known`: what is registered elsewhere already, by name: another value of such a name is left out too. `extras`:
    those entry points alone that name an extra, as `engines.exudyn:VARIANTS [exudyn]` does; else those that name none.
    """
    values: dict[str, Any] = {}
    owners = dict.fromkeys(known, "another group")
    troubles: list[str] = []
    for owner, key, whole in (*_ours(group), *_theirs(group)):
        reference, extra, _ = whole.partition("[")
        if bool(extra) != extras:
            continue
        about = f"{group}: {key!r} of the distribution {owner}"
        try:
            found = load(reference.strip(), kind)
        except ValueError as reason:
            troubles.append(f"{about} is left out: {reason}")
            continue
        for value in found:
            word = name(value)
            if word in owners and value != {**known, **values}[word]:
                troubles.append(f"{about}: {word!r} is left out, since {owners[word]} has one of this name")
            elif word not in values:
                values[word], owners[word] = value, owner
    return Registered(tuple(values.values()), tuple(troubles))


def registered_by_key(group: str, kind: Kind) -> dict[str, Any]:
    """The first value of each key of a group; one of a key that ours has is left out.

    So is what can't be used: with a warning, unless a package is not installed that it needs.
    """
    found: dict[str, Any] = {}
    for owner, key, reference in (*_ours(group), *_theirs(group)):
        try:
            value = load(reference, kind)[0]
        except ValueError as reason:
            if not _lacks_a_package(reason.__context__):
                warnings.warn(f"{group}: {key!r} of the distribution {owner} is left out: {reason}", stacklevel=2)
            continue
        found.setdefault(key, value)
    return found


def _lacks_a_package(error: BaseException | None) -> bool:
    """Whether an import failed since a package that is none of ours is not installed."""
    lacking = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    return lacking not in ("", "reference", "engines", "reports")


@cache
def _checkout() -> dict[str, Any] | None:
    """The project table of the pyproject.toml beside these packages; None where there is none, or another project's."""
    file = ROOT / "pyproject.toml"
    if not file.is_file():
        return None
    with file.open("rb") as stream:
        project = tomllib.load(stream).get("project", {})
    return project if project.get("name") == OURS else None


def _ours(group: str) -> list[tuple[str, str, str]]:
    """(distribution, key, reference) of what we register, by key: the order of a file is lost in an installation."""
    project = _checkout()
    if project is not None:
        points = project.get("entry-points", {}).get(group, {}).items()
    else:
        points = ((point.name, point.value) for point in metadata.entry_points(group=group) if _owner(point) == OURS)
    return sorted((OURS, key, value) for key, value in points)


def _theirs(group: str) -> list[tuple[str, str, str]]:
    """(distribution, key, reference) of what others register, in an order that does not depend on the path."""
    points = [(_owner(point), point.name, point.value) for point in metadata.entry_points(group=group)]
    return sorted(point for point in points if point[0] != OURS)


def _owner(point: metadata.EntryPoint) -> str:
    return point.dist.name if point.dist is not None else "unknown"
