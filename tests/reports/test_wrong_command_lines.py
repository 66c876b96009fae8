"""Random wrong command lines over all commands end in a status and one line, and never in a traceback."""

from __future__ import annotations

import random

import pytest
import typer

from reports.cli.commands import app
from reports.model.ending import BROKEN, FINE, REFUSED
from tests.reports.test_command_line import call, here

__all__ = ["here"]

COMMANDS = {
    name: [option for each in command.params for option in each.opts if option.startswith("--")]
    for name, command in sorted(vars(typer.main.get_command(app))["commands"].items())
}
FREE = ("", " ", "\x1b[31m", "\udcff", "file\nname", "x" * 5000, "é" * 300)  # and what a shell would split
WORDS = (
    *FREE,
    *[".", "..", "/", "/dev/null", "/dev/zero", "-", "--", "-1", "0", "1e400", "nan", "-inf", "1e-320"],
    *("9" * 30, "mujoco tuned"),
    *[
        "free_four_bar",
        "FREE",
        "pymunk",
        "lagrange",
        "default",
        "nope",
        "a=b",
        "=",
        "crank=",
        "crank=0",
        "x.py",
        "x.py:A",
        "a:b:c",
        "reference:SCENES",
    ],
    *[
        "os:path",
        "model.xml",
        "<b>",
        "[bold]",
        "*",
        "'",
        '"',
        "%s",
        "{0}",
        "tcp://127.0.0.1:1",
        "local:0",
        "pymunk==0",
        "CON",
    ],
)
# A command that is right would do its work: each has something that no command takes, or that is nothing.
WRONG = ("nope_nope", "nope_nope", "nope_nope", "--nonsense")


def wrong_line(chance: random.Random) -> list[str]:
    name = chance.choice([*COMMANDS])
    words = [name]
    for _ in range(chance.randint(0, 3)):
        words += [chance.choice(COMMANDS[name]), chance.choice(WORDS)] if chance.random() < 0.7 else []
        words += [chance.choice(WORDS)] if chance.random() < 0.3 else []
    words.insert(1 if chance.random() < 0.5 else len(words), chance.choice(WRONG))
    return words


def one_end(words, capfd):
    status = call(*words)
    out, err = capfd.readouterr()
    assert status in (FINE, BROKEN, REFUSED), words
    assert "Traceback" not in out + err, words
    if status == REFUSED:  # above the line there may be one of progress
        told = [line.startswith("crosscheck: ") for line in err.splitlines()]
        assert sum(told) == 1, (words, err)
        assert told[-1], (words, err)


@pytest.mark.parametrize("count", [40, pytest.param(240, marks=pytest.mark.slow)])
def test_a_wrong_command_line_is_one_line(count, here, capfd):
    chance = random.Random(22)
    for _ in range(count):
        one_end(wrong_line(chance), capfd)


@pytest.mark.parametrize(
    "words",
    [
        ("run", "free_four_bar", "--every", "3000000000"),
        ("run", "free_four_bar", "--every", "0"),
        ("run", "free_four_bar", "--step", "1e-320"),
        ("run", "free_four_bar", "--step", "1e-300"),
        ("run", "free_four_bar", "--step", "nan"),
        ("view", "free_four_bar", "--variant", "nope"),
        ("animate", "free_four_bar", "--every", "1" + 20 * "0"),
        ("animate", "free_four_bar", "--every", "0"),
        ("check", "one.xml", "--markdown", ""),
        ("check", "one.xml", "--html", "."),
        ("shapes", "/dev/zero"),
    ],
)
def test_what_once_ended_in_a_traceback_is_one_line(words, here, capfd):
    assert call(*words) == REFUSED
    err = capfd.readouterr().err
    assert err.startswith("crosscheck: ")
    assert err.count("\n") == 1
    assert list(here.iterdir()) == []
