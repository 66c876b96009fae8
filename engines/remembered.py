"""A cache for results that depend on a mechanism or a rolling pair."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

Cached = TypeVar("Cached", bound=Callable[..., Any])


def by_identity(size: int = 8) -> Callable[[Cached], Cached]:
    """Cache the last `size` results of a function; the first argument is compared by identity.

    Calls with keyword arguments are not cached.
    """

    def with_cache(function: Cached) -> Cached:
        cache: deque[tuple[tuple[Any, ...], Any]] = deque(maxlen=size)

        @wraps(function)
        def cached(*arguments: Any, **named: Any) -> Any:
            if named or not arguments:
                return function(*arguments, **named)
            for (first, *others), result in cache:
                if first is arguments[0] and tuple(others) == arguments[1:]:
                    return result
            result = function(*arguments)
            cache.append((arguments, result))
            return result

        return cached  # type: ignore[return-value]

    return with_cache
