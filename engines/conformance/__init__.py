"""The requirements of an engine as named checks, in small mechanisms whose motions are known in closed form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from engines import Engine, method_name
from engines.conformance import members, moving, same
from engines.conformance.check import Case, Check, Result, Status, Subject
from engines.imported_release import other_release

CHECKS: tuple[Check, ...] = (*members.CHECKS, *moving.CHECKS, *same.CHECKS)


def cases(*engines: Engine) -> Iterator[Case]:
    """Every check of every engine, in each of its mechanisms."""
    for engine in engines:
        subject = Subject(engine)
        for check in CHECKS:
            if not check.worlds:
                yield Case(subject, check)
            for world in check.worlds:
                yield Case(subject, check, world)


def conform(engine: Engine, expected_failures: Mapping[str, str] | None = None) -> tuple[tuple[Case, Result], ...]:
    """Run all checks of an engine; returns every case with its result.

    expected_failures: the reason of each expected failure, by the check's name or `check: mechanism`. Raises
    AssertionError, with a line for each unexpected failure, each expected failure that holds, and each unknown name;
    ValueError where the engine's code is of another release than its metadata say.
    """
    if sentence := other_release([engine]):
        raise ValueError(sentence)
    expected = dict(expected_failures or {})
    results = tuple((case, case.result()) for case in cases(engine))
    came, wrong = set[str](), list[str]()
    for case, result in results:
        full = case.check.name if case.world is None else f"{case.check.name}: {case.world.name}"
        names = {case.check.name, full} & set(expected)
        if result.status == "fails":
            came |= names
            wrong += [] if names else [f"{full}: {result.sentence}"]
    asked = {case.check.name for case, _ in results}
    for name, why in expected.items():
        if name.split(": ")[0] not in asked:
            wrong.append(f"{name!r} is no check; there are {', '.join(sorted(asked))}")
        elif not why.strip():
            wrong.append(f"{name}: it is expected to fail, and no reason is given")
        elif name not in came:
            wrong.append(f"{name}: it was expected to fail ({why}), and it does not: take it out of what is expected")
    if wrong:
        raise AssertionError(f"{method_name(engine)} does not conform:\n" + "\n".join(wrong))
    return results


__all__ = ["CHECKS", "Case", "Check", "Result", "Status", "Subject", "cases", "conform"]
