"""CPU time of a process by parts, each without the time of the parts inside it.

It is always counted, since reading the clock takes a microsecond; only `crosscheck bench suite` prints it.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

_spent: defaultdict[str, float] = defaultdict(float)
_inside: list[float] = []  # CPU time [s] of the inner parts, for each open part


@contextmanager
def spending(part: str) -> Iterator[None]:
    """Count the CPU time [s] of the block, without the parts inside it that are counted separately."""
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
    """Part -> CPU seconds since the last call."""
    out = dict(_spent)
    _spent.clear()
    return out
