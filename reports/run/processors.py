"""Processors for workers: those that this process may use, and those whose work does not slow another's."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

TOPOLOGY = Path("/sys/devices/system/cpu")


def usable() -> tuple[int, ...]:
    """The numbers of the processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return tuple(sorted(os.sched_getaffinity(0)))
    return tuple(range(os.cpu_count() or 1))


def usable_cores() -> int:
    """How many processors this process may use."""
    return len(usable())


def apart() -> tuple[int, ...]:
    """Of the processors that this process may use one of each core: two of one core share its units and caches.

    All of them where the system does not tell which ones are of one core.
    """
    cores: dict[str, int] = {}
    for number in usable():
        core = str(number)
        with suppress(OSError):
            core = (TOPOLOGY / f"cpu{number}/topology/thread_siblings_list").read_text(encoding="ascii").strip()
        cores.setdefault(core, number)
    return tuple(cores.values())


def stay_on(processor: int | None) -> None:
    """Keep this process, and what it starts, on one processor; None, or a system that can't: where it was."""
    if processor is not None and hasattr(os, "sched_setaffinity"):
        with suppress(OSError):  # taken away meanwhile
            os.sched_setaffinity(0, {processor})
