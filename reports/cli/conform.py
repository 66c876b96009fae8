"""`crosscheck conform`: whether an engine does what the contract of `engines` says, one line a check."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.options import REFERENCES, AsJson, AsMarkdown
from reports.model.ending import BadInput, Broken

if TYPE_CHECKING:
    from engines.conformance import Case, Result, Status

WIDTH = 150  # into a file or a pipe


def conform(
    engine: Annotated[str, typer.Argument(help=f"An engine's name, or {REFERENCES}.")],
    variant: Annotated[str | None, typer.Option("--variant", help="Only this variant.")] = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
) -> None:
    """Check that an engine keeps the contract: signs, instants, orders, refusals, and any description alike."""
    from engines.registry import method_name, mislabelled
    from reports.cli.supervised_checks import Named, asked
    from reports.cli.terminal import print_table, telling

    if sentence := mislabelled():
        raise BadInput(sentence)
    with telling(WIDTH, as_json, as_markdown) as screen:
        broken = []
        for each, results in asked(Named.here(engine, variant)):
            name = method_name(each)
            screen.say(name)
            lines = []
            for status, line in verdicts(results):
                screen.say(f"  {status:<14} {line}")  # as it comes: some checks take seconds
                lines.append((status, line))
            count = sum(status == "fails" for status, _ in lines)
            told = "every check holds" if not count else f"{count} checks fail"
            if screen.form == "text":
                screen.say(f"  {told}")
            else:
                print_table(screen, f"{name}: {told}", ("answer", "check"), lines, 2)
            if count:
                broken.append(name)
        if broken:
            raise Broken(f"{', '.join(broken)}: not as the contract of an engine says")


def verdicts(results: Iterator[tuple[Case, Result]]) -> Iterator[tuple[Status, str]]:
    """The status and the line of every check, and a line for every reason why something was not asked, once."""
    said: set[str] = set()
    for check, group in groupby(results, key=lambda found: found[0].check):
        told = list(group)
        failed, held = _of(told, "fails"), _of(told, "holds")
        if failed:
            yield "fails", f"{_names(failed)}{failed[0][1].sentence}"
        elif held:
            share = "" if not check.worlds else f" ({len(held)} of {len(told)} mechanisms)"
            yield "holds", f"{check.name}{share}"
        for status in ("not supported", "not asked"):
            for case, result in _of(told, status):
                words = f"{_names([(case, result)])}{result.sentence}"
                if words not in said:
                    yield status, words if held or failed or case.world is None else f"{check.name}: {words}"
                said.add(words)


def _of(told: Sequence[tuple[Case, Result]], status: str) -> list[tuple[Case, Result]]:
    return [found for found in told if found[1].status == status]


def _names(told: Sequence[tuple[Case, Result]]) -> str:
    """In which mechanisms, and with which joints."""
    names = [f"{case.world.name} ({', '.join(case.world.kinds)})" for case, _ in told if case.world is not None]
    return f"in {'; '.join(names)}: " if names else ""
