"""What every user of pymunk or MuJoCo should know: ten findings, each told only while its rows bear it out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from reports.model.page import Material, Page
from reports.pages.findings.bodies import contact, energy, forces, iterations, skate
from reports.pages.findings.finding import Finding
from reports.pages.findings.linkages import crank, luck, reading, spring, tuned
from reports.pages.findings.lookup import Rows
from reports.pages.findings.pictures import draw
from reports.plots.theme import svg

FINDINGS: tuple[Callable[[Rows], Finding], ...] = (
    spring,
    tuned,
    luck,
    reading,
    energy,
    iterations,
    forces,
    skate,
    crank,
    contact,
)


def findings(pages: Mapping[Page, Material]) -> list[Finding]:
    """Those that these rows bear out, in the order of FINDINGS."""
    rows = Rows(pages)
    return [found for find in FINDINGS if (found := find(rows)).told]


def pictures(told: Iterable[Finding]) -> dict[str, str]:
    """The SVG text of each finding's picture by file name."""
    return {found.picture: svg(draw(found.lines, found.quantity), found.title) for found in told}
