"""The commands of the command line, and its help; each command has a file of its own."""

from __future__ import annotations

from collections.abc import Sequence

import typer

from reports.cli.animate import animate
from reports.cli.atlas import atlas
from reports.cli.bench import bench
from reports.cli.check import check
from reports.cli.compare import compare
from reports.cli.conform import conform
from reports.cli.errata import errata
from reports.cli.export import export, view
from reports.cli.report import report
from reports.cli.run import run
from reports.cli.search import search
from reports.cli.shapes import shapes
from reports.cli.show import list_command, show
from reports.cli.site import site
from reports.cli.streams import written
from reports.cli.versions import versions
from reports.model.ending import FINE, STATUSES

app = typer.Typer(
    help="How far a physics engine's constraints are from ideal ones, on planar mechanisms with an analytic truth.",
    epilog=STATUSES,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command("list")(list_command)
app.command("run")(run)
app.command("show")(show)
app.command("report")(report)
app.command("bench")(bench)
app.command("shapes")(shapes)
app.command("errata")(errata)
app.command("conform")(conform)
app.command("search")(search)
app.command("atlas")(atlas)
app.command("versions")(versions)
app.command("compare")(compare)
app.command("animate")(animate)
app.command("site")(site)
app.command("check")(check)
app.command("export")(export)
app.command("view")(view)


def invoke(arguments: Sequence[str]) -> int:
    """Run a command; its exit status. Raises what it raises, and the usage errors of typer."""
    command = typer.main.get_command(app)
    status = FINE
    try:
        # Not its own `main`: that turns a closed pipe and Ctrl-C into statuses of its own.
        with written():  # the help, if it is asked for
            context = command.make_context("crosscheck", list(arguments) or ["--help"])
        with context:
            command.invoke(context)
    except typer.Exit as done:
        status = done.exit_code
    with written():
        return status
