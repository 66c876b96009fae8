"""CPU time of a process by parts, each without the time of the parts inside it.

Always counted, since a look at the clock takes a microsecond; asked by `crosscheck bench suite` alone.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

_spent: defaultdict[str, float] = defaultdict(float)
_inside: list[float] = []  # of each part that is open, the time of the parts in it


@contextmanager
def spending(part: str) -> Iterator[None]:
    """Count the CPU time [s] of what is inside, but for the parts in it that are counted apart."""
    begin = time.process_time()
    _inside.append(0.0)
    try:
        yield
    finally:
        whole = time.process_time() - begin
        _spent[part] += whole - _inside.pop()
        if _inside:
            _inside[-1] += whole


def taken() -> Mapping[str, float]:
    """CPU seconds by part since the last call."""
    out = dict(_spent)
    _spent.clear()
    return out
