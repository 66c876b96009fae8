"""The table of commands. Commands start quickly, since only the module of the running command is imported."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import typer

from reports.cli.streams import written
from reports.model.ending import FINE, STATUSES, BadInput

# Command -> (module and function in `reports.cli`, first sentence of the help).
COMMANDS = {
    "list": ("show:list_command", "List scenes, engines and variants, and unsupported combinations with the reason."),
    "run": ("run:run", "Run the cells that are not stored yet. An interrupted run can be continued."),
    "show": ("show:show", "Print a scene's stored numbers: every run, order and plateau, and its experiments."),
    "report": ("report:report", "Write pages, charts, errors.csv and timings.csv from the stored results."),
    "bench": ("bench:bench", "Compare the CPU times of `run` and of bare loops."),
    "shapes": ("shapes:shapes", "Write the two shapes that generate a motion when the one rolls on the other."),
    "errata": ("show:errata", "The chapter's printed slips: each formula's value as printed and as it must be."),
    "conform": ("conform:conform", "Check that an engine keeps the contract: signs, instants, orders, refusals."),
    "search": ("search:search", "Search random mechanisms for faults, and reduce and write each finding."),
    "atlas": ("atlas:atlas", "Map where methods fail: step against the parameter that breaks a scene."),
    "versions": ("versions:versions", "Run scenes in released versions of an engine."),
    "compare": ("compare:compare", "Print changes of errors, orders, outcomes and costs from A to B."),
    "animate": ("animate:animate", "Write a picture that moves: the exact motion, and what engines make of it."),
    "site": ("site:site", "Write the results as a static site: lessons, tables, charts, engines in the page."),
    "check": ("check:check", "Check a model of your own against ideal joints: how wrong, why, what is enough."),
    "export": ("export:export", "Write a scene as a file that runs without this suite, with its truth in comments."),
    "view": ("export:view", "Look at a scene: in an engine's viewer, or else as an animation in a file."),
}
# The fork server imports engines and these modules for all workers while this process imports the command. In `run` few
# cells need numba, whose import takes longer than most cells.
EARLY = {"run": ("scipy.integrate", "llvmlite.binding"), "search": ("scipy.integrate", "numba")}
LOOK: Any = {"add_completion": False, "pretty_exceptions_enable": False, "rich_markup_mode": None}


def command(name: str) -> Any:
    """The parser for the options of a command."""
    module, _, function = COMMANDS[name][0].partition(":")
    app = typer.Typer(**LOOK)
    app.command(name)(getattr(import_module(f"reports.cli.{module}"), function))
    return typer.main.get_command(app)


def program() -> Any:
    """The parser that prints the help and refuses an unknown command."""
    about = "How far a physics engine's constraints are from ideal ones, on planar mechanisms with an analytic truth."
    app = typer.Typer(help=about, epilog=STATUSES, **LOOK)
    for name, (_, words) in COMMANDS.items():
        app.command(name, help=words)(lambda: None)
    return typer.main.get_command(app)


def invoke(arguments: Sequence[str]) -> int:
    """Run a command and return its exit status. Exceptions of the command and of typer are raised."""
    words = list(arguments) or ["--help"]
    status = FINE
    try:
        # The `main` of typer is not called, since it changes the exit status after Ctrl-C and for a closed pipe.
        with written():  # For --help.
            if words[0] in COMMANDS:
                if words[0] in EARLY and "--help" not in words:
                    from reports.run import worker  # Other commands start sooner without multiprocessing.

                    worker.start_early(*EARLY[words[0]])
                parser, called, words = command(words[0]), f"crosscheck {words[0]}", words[1:]
            else:
                parser, called = program(), "crosscheck"
            context = parser.make_context(called, list(words))
        _refuse_repeated(parser.make_parser(context).parse_args(list(words))[2])
        with context:
            parser.invoke(context)
    except typer.Exit as done:
        status = done.exit_code
    with written():
        return status


def _refuse_repeated(parameters: Sequence[Any]) -> None:
    for parameter in parameters:
        if parameter.param_type_name == "option" and not parameter.multiple and parameters.count(parameter) > 1:
            words = "/".join((*parameter.opts, *parameter.secondary_opts))
            raise BadInput(f"{words} is given {parameters.count(parameter)} times; give it once")
