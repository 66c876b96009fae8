"""What installed distributions require in turn: pymunk calls its engine through cffi, which no file of ours imports."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from importlib import metadata


def with_required(distributions: Iterable[str]) -> set[str]:
    """The distributions and all that they require, directly or not, as far as it is installed; normalised names.

    What only an extra asks for is left out, since whether it is installed says nothing about whether it is used.
    """
    found: set[str] = set()
    waiting = list(distributions)
    while waiting:
        name = normalised(waiting.pop())
        if name in found:
            continue
        requirements = _required(name)
        if requirements is None:  # asked for on other systems only
            continue
        found.add(name)
        waiting += requirements
    return found


@cache  # reading what is installed takes longer than all else that a key needs
def _required(name: str) -> tuple[str, ...] | None:
    """What an installed distribution requires; None if it is not installed."""
    try:
        requirements = metadata.requires(name) or []
    except metadata.PackageNotFoundError:
        return None
    return tuple(_name(text) for text in requirements if not re.search(r"\bextra\s*==", text))


def normalised(name: str) -> str:
    """As package indexes compare names."""
    return re.sub(r"[-_.]+", "-", name).lower()


def _name(requirement: str) -> str:
    """'cffi' of 'cffi>=1.17.1; python_version < "3.14"'."""
    match = re.match(r"\s*([A-Za-z0-9][A-Za-z0-9._-]*)", requirement)
    return match[1] if match else ""
