"""What every engine has to pass, ours and anybody's: named checks in small mechanisms whose motions are known."""

from __future__ import annotations

from collections.abc import Iterator

from engines import Engine
from engines.conformance import members, moving, refusing, same, sampled
from engines.conformance.check import Case, Check, Result, Status, Subject

CHECKS: tuple[Check, ...] = (
    *refusing.CHECKS,
    *members.CHECKS,
    *sampled.CHECKS,
    *moving.CHECKS,
    *same.CHECKS,
)


def cases(*engines: Engine) -> Iterator[Case]:
    """Every check of every engine, in every mechanism that it is asked in."""
    for engine in engines:
        subject = Subject(engine)
        for check in CHECKS:
            if not check.worlds:
                yield Case(subject, check)
            for world in check.worlds:
                yield Case(subject, check, world)


__all__ = ["CHECKS", "Case", "Check", "Result", "Status", "Subject", "cases"]
