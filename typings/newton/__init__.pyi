"""A compiled package, or an extra: every name in it is of any type."""

from typing import Any

def __getattr__(name: str) -> Any: ...
