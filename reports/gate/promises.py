"""What theory promises of a method: with which power of the step each of its errors falls."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from engines import Promise

# Method -> promise; (scene, method) -> promise where a scene's motion makes it another.
Promises = Mapping[Any, Promise]  # Any: a key of either kind, since a Mapping's keys are invariant


def promised(promises: Promises, scene: str, method: str) -> Promise:
    """The promise of a method in a scene; raises KeyError for a method without one."""
    return promises[scene, method] if (scene, method) in promises else promises[method]
