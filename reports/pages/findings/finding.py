"""A finding: a sentence with its numbers from the rows, what has to hold for it, and a small picture for telephones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from reports.model.quantities import quantity
from reports.plots.looks import colour
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes
from reports.write.rows import Rows
from reports.write.unmeasured import MARK

# Inches, 360 pixels of a browser: a telephone shows it unscaled, so that the letters keep their size.
WIDTH, HEIGHT = 3.75, 2.55
# By position, so that lines of one colour, and all of them in grey, differ by dashes, marks and filling.
LOOKS: tuple[dict[str, Any], ...] = (
    {"linestyle": ":", "marker": "o", "filled": False},
    {"linestyle": "--", "marker": "s", "filled": True},
    {"linestyle": "-", "marker": "D", "filled": True},
    {"linestyle": "-.", "marker": "^", "filled": False},
)


@dataclass(frozen=True)
class Line:
    """Rows of one engine from coarse to fine, under a label that a reader of the finding understands."""

    label: str
    rows: Rows


def axis_label(name: str) -> str:
    """What stands beside the errors: the quantity with its unit."""
    told = quantity(name)
    return f"{told.label} error [{told.unit}]"


def draw(lines: Sequence[Line], name: str, theme: Theme = LIGHT) -> Figure:
    """Errors of the quantity of this name against the step [ms], both logarithmic; an engine has its own colour.

    Raises ValueError for more lines than there are looks.
    """
    if len(lines) > len(LOOKS):
        raise ValueError(f"a finding's picture has {len(lines)} lines; it must have at most {len(LOOKS)}")
    with settings():
        figure = new_figure(HEIGHT, theme, WIDTH)
        axes = figure.subplots()
        for line, look in zip(lines, LOOKS, strict=False):
            if not line.rows:
                continue
            paint, shown = colour(line.rows[0].engine, theme), line.rows.points(name)
            axes.plot(
                [1e3 * step for step, _ in shown],
                [error for _, error in shown],
                label=line.label,
                color=paint,
                linestyle=look["linestyle"],
                marker=look["marker"],
                markerfacecolor=paint if look["filled"] else theme.paper,
                markeredgecolor=paint,
                markersize=5,
                linewidth=1.6,
            )
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("step [ms]")
        axes.set_ylabel(axis_label(name))
        style_axes(axes, theme)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(base=10, numticks=7))
            axis.set_minor_formatter(NullFormatter())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.minorticks_off()
        legend = figure.legend(loc="outside upper left", ncols=1, frameon=False, handlelength=3.2, fontsize=8.5)
        for text in legend.get_texts():
            text.set_color(theme.ink)
    return figure


MILLISECOND = 1e-3  # s, the step at which findings compare: the grid of nearly every scene has it
TENTH = 1e-4  # s


@dataclass(frozen=True)
class Finding:
    """name: of the picture; title and text: Markdown, without the link to the page; lines: what the picture shows."""

    name: str
    title: str
    text: str
    page: str
    holds: bool
    lines: tuple[Line, ...]
    quantity: str  # of the picture, a name in `reports.model.quantities`

    @property
    def picture(self) -> str:
        """The name of its file."""
        return f"finding_{self.name}.svg"

    @property
    def alternative(self) -> str:
        """The picture in words, for who can't see it."""
        shown = "; ".join(line.label for line in self.lines)
        return f"{axis_label(self.quantity)} against step [ms]: {shown}"

    @property
    def told(self) -> bool:
        """Whether the rows have its numbers and bear its claims out."""
        return self.holds and MARK not in self.title + self.text
