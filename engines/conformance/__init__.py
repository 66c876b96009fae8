"""Named checks of the contract in small mechanisms whose exact motions are known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from engines import Engine, method_name
from engines.conformance import members, moving, same
from engines.conformance.check import CheckedEngine, ConformanceCase, ConformanceCheck, ConformanceResult, Status
from engines.imported_release import other_release

CHECKS: tuple[ConformanceCheck, ...] = (*members.CHECKS, *moving.CHECKS, *same.CHECKS)


def cases(*engines: Engine) -> Iterator[ConformanceCase]:
    """All cases: every check of every engine in every mechanism of the check."""
    for engine in engines:
        subject = CheckedEngine(engine)
        for check in CHECKS:
            for world in check.worlds or (None,):
                yield ConformanceCase(subject, check, world)


def conform(
    engine: Engine, expected_failures: Mapping[str, str] | None = None
) -> tuple[tuple[ConformanceCase, ConformanceResult], ...]:
    """Run all checks of an engine; returns every case with its result.

    expected_failures: reasons for expected failures, by name of the check or `check: mechanism`.
    Raises AssertionError with a line for each unexpected failure, each expected failure that does not occur, and each
    unknown name. Raises ValueError if the engine's code and its metadata belong to different releases.
    """
    if sentence := other_release([engine]):
        raise ValueError(sentence)
    expected = dict(expected_failures or {})
    results = tuple((case, case.result()) for case in cases(engine))
    confirmed, wrong = set[str](), list[str]()
    for case, result in results:
        full = case.check.name if case.world is None else f"{case.check.name}: {case.world.name}"
        names = {case.check.name, full} & set(expected)
        if result.status == "fails":
            confirmed |= names
            wrong += [] if names else [f"{full}: {result.sentence}"]
    checks = {case.check.name for case, _ in results}
    for name, reason in expected.items():
        if name.split(": ")[0] not in checks:
            wrong.append(f"{name!r} is no check; there are {', '.join(sorted(checks))}")
        elif not reason.strip():
            wrong.append(f"{name}: it is expected to fail, and no reason is given")
        elif name not in confirmed:
            wrong.append(
                f"{name}: it was expected to fail ({reason}), and it does not: remove it from expected_failures"
            )
    if wrong:
        raise AssertionError(f"{method_name(engine)} does not conform:\n" + "\n".join(wrong))
    return results


__all__ = [
    "CHECKS",
    "CheckedEngine",
    "ConformanceCase",
    "ConformanceCheck",
    "ConformanceResult",
    "Status",
    "cases",
    "conform",
]
