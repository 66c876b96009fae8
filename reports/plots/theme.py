"""Colours for light and dark backgrounds, and SVG texts that follow the reader's colour scheme."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

FIGURE_WIDTH = 9.2  # inches; GitHub does not scale pictures of this width


@dataclass(frozen=True)
class Theme:
    """A colour for each role. The defaults are for a light background. Roles must have different colours, because a
    stylesheet finds a role in an SVG by its colour."""

    paper: str = "#fdfdfc"
    ink: str = "#1f2328"
    quiet: str = "#5d6670"
    grid: str = "#dfe3e8"
    first: str = "#c2410c"
    second: str = "#1d5fbf"
    third: str = "#2f7d4f"
    fourth: str = "#8b3fa0"
    fifth: str = "#0b7a8f"
    sixth: str = "#94610a"
    seventh: str = "#b8336a"
    eighth: str = "#55606e"
    exact: str = "#eaf6ee"
    fine: str = "#cfe9d7"
    good: str = "#b3dcc0"
    fair: str = "#c9cd66"
    middling: str = "#e0ab3a"
    bad: str = "#de8468"
    worse: str = "#9f8ac6"


LIGHT = Theme()
DARK = Theme(
    paper="#15191f",
    ink="#e6eaef",
    quiet="#9aa4af",
    grid="#333b45",
    first="#ff9457",
    second="#74aefc",
    third="#6fcf97",
    fourth="#d79be8",
    fifth="#4fcfe3",
    sixth="#e6b84a",
    seventh="#f78bb6",
    eighth="#b9c3ce",
    exact="#12291c",
    fine="#1a4630",
    good="#226340",
    fair="#55601a",
    middling="#7a5a12",
    bad="#ac4831",
    worse="#55437f",
)

# Roles of families of engines in charts, and of lines in other pictures.
SERIES = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth")

RC_SETTINGS = {
    "svg.hashsalt": "crosscheck",
    "svg.fonttype": "none",  # text is not converted to paths
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "hatch.linewidth": 0.6,
    "legend.frameon": False,
    "legend.labelcolor": LIGHT.ink,
    "axes.titlecolor": LIGHT.ink,
    "axes.titley": 1.0,  # without a fixed position, matplotlib measures all ticks to place titles
}


# Verdana replaces DejaVu Sans on systems without it, and has letters of the same widths.
FONTS = "'DejaVu Sans', Verdana, sans-serif"
# Names that matplotlib derives from coordinates. The last bits of coordinates may differ between runs.
DIGESTED = re.compile(r"\b([mpCh][0-9a-f]{10})\b")


def settings() -> AbstractContextManager[None]:
    import matplotlib

    plain: dict[Any, Any] = {**matplotlib.rcParamsDefault, **RC_SETTINGS}
    return matplotlib.rc_context(plain)


def new_figure(height: float, theme: Theme = LIGHT, width: float = FIGURE_WIDTH) -> Figure:
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), facecolor=theme.paper, layout="constrained")


@contextmanager
def drawing(height: float, width: float = FIGURE_WIDTH) -> Iterator[Figure]:
    with settings():
        yield new_figure(height, LIGHT, width)


def note(panel: Axes, text: str, point: ArrayLike, offset: tuple[float, float], color: str, **style: Any) -> None:
    """Write a text at an offset [1/72 inch] from a data point."""
    panel.annotate(text, point, xytext=offset, textcoords="offset points", color=color, **style)  # type: ignore[arg-type]


def add_legend(figure: Figure, handles: Sequence[Line2D], columns: int, **style: Any) -> None:
    """Write a legend below the panels, in the largest number of columns, at most `columns`, that fits the figure."""
    legend = figure.legend(handles=handles, loc="outside lower center", ncols=columns, **style)
    if columns > 1 and legend.get_window_extent().width > figure.bbox.width:
        legend.remove()
        add_legend(figure, handles, columns - 1, **style)


def style_axes(axes: Axes, theme: Theme = LIGHT, grid: bool = True) -> None:
    """Give axes a grey frame, grey ticks, and a grid behind the data."""
    axes.set_facecolor(theme.paper)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(theme.quiet)
    axes.tick_params(which="both", colors=theme.quiet, labelcolor=theme.ink)
    axes.xaxis.label.set_color(theme.ink)
    axes.yaxis.label.set_color(theme.ink)
    axes.title.set_color(theme.ink)
    if grid:
        axes.grid(True, which="major", color=theme.grid, linewidth=0.7)
    axes.set_axisbelow(True)


def label_decades(
    axis: Axis,
    count: int | None = None,
    ticks: Sequence[float] = (1.0,),
    label: Callable[[float], str] | None = None,
) -> None:
    """Place labels of a logarithmic axis only at `ticks` times powers of ten, at most `count` of them. label: value ->
    text."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(10, ticks, numticks=count))
    if label is not None:
        axis.set_major_formatter(FuncFormatter(lambda value, _: label(value)))
    axis.set_minor_formatter(NullFormatter())


def bare(panel: Axes, title: str) -> None:
    """Hide the axes of a panel and give them equal scales."""
    style_axes(panel, grid=False)
    panel.set_axis_off()
    panel.set_aspect("equal")
    panel.set_title(title, loc="left", fontsize=9, color=LIGHT.ink)


def svg(figure: Figure, title: str) -> str:
    """A figure in the colours of LIGHT as a reproducible SVG text. A stylesheet replaces the colours in a dark scheme.
    `title` is the text for screen readers."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    from reports.plots.powers import label_in_powers

    out = io.StringIO()
    label_in_powers(figure)
    with settings():
        FigureCanvasSVG(figure).print_svg(out, metadata={"Date": None, "Creator": None, "Title": title})
    text = _renumbered(out.getvalue()).replace("'DejaVu Sans'", FONTS)
    rules = []
    for field in fields(Theme):
        light, dark = getattr(LIGHT, field.name), getattr(DARK, field.name)
        for kind in ("fill", "stroke"):
            if f"{kind}: {light}" in text:
                rules.append(f'[style*="{kind}: {light}"] {{ {kind}: {dark} !important }}')
    sheet = "\n".join(["<style>@media (prefers-color-scheme: dark) {", *rules, "}</style>"])
    text = re.sub(r"(<svg [^>]*>)", lambda match: match.group(1) + "\n" + sheet, text, count=1)
    return re.sub(r"[ \t]+$", "", text, flags=re.MULTILINE)


def _renumbered(text: str) -> str:
    """The SVG text with consecutive numbers in names of clips, marks and hatches."""
    names: dict[str, str] = {}
    return DIGESTED.sub(lambda match: names.setdefault(match[1], f"{match[1][0]}{len(names) + 1}"), text)
