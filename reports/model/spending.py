"""CPU time of the parts of a process. The time of a part does not include the parts inside it.

The time is always measured, since reading the clock takes only a microsecond. `crosscheck bench suite` prints the time.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

# CPU times within this factor count as equal, since timings of short runs scatter by about a fifth.
EQUAL_COST_FACTOR = 1.25

_spent: defaultdict[str, float] = defaultdict(float)
_inside: list[float] = []  # For each open part: CPU time [s] of the parts inside it.


@contextmanager
def spending(part: str) -> Iterator[None]:
    """Measure the CPU time [s] of a block. The parts inside the block are measured separately."""
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
    """Part -> CPU seconds since the last call of this function."""
    out = dict(_spent)
    _spent.clear()
    return out
