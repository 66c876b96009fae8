"""A motion as a film: frames drawn by matplotlib, written as GIF by pillow, or as MP4 by ffmpeg where that is found."""

from __future__ import annotations

import shutil
from importlib import import_module
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from reference.plane import rotated
from reports.model.ending import BadInput
from reports.plots.theme import LIGHT, Theme, settings, style_axes
from reports.site import drawn
from reports.site.animated import LOOKS, SECONDS, decades
from reports.site.embed import Shown

Array = NDArray[np.float64]

FRAMES = 60
INCHES = (7.0, 3.2)
DOTS = 90  # an inch


def film(shown: Shown, title: str, path: Path, theme: Theme = LIGHT) -> None:
    """Write the film to a path that ends in .gif or .mp4. Raises BadInput where ffmpeg is needed and not there."""
    program = ffmpeg() if path.suffix == ".mp4" else None
    frames = np.unique(np.linspace(0, len(shown.t) - 1, FRAMES).round().astype(int))
    rate = max(1, round(len(frames) / SECONDS))  # a whole number of frames a second, as films have
    with settings():
        figure = Figure(figsize=INCHES, facecolor=theme.paper, layout="constrained")
        stage, chart = figure.subplots(1, 2, width_ratios=(1.2, 1))
        figure.suptitle(title, fontsize=11, color=theme.ink, x=0.02, ha="left")
        moving = _stage(stage, shown, theme)
        growing = _chart(chart, shown, theme)
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # once is enough: the panels stay where they are

        def draw(frame: int) -> list[Line2D]:
            for line, points, pose in moving:
                line.set_data(*(rotated(pose[frame, 2], points) + pose[frame, :2]).T)
            for line, error in growing:
                line.set_data(shown.t[: frame + 1], error[: frame + 1])
            return [line for line, *_ in (*moving, *growing)]

        made = FuncAnimation(figure, lambda index: draw(int(frames[index])), frames=len(frames), blit=False)
        if program is None:
            made.save(str(path), writer=PillowWriter(fps=rate), dpi=DOTS)
        else:
            with rc_context({"animation.ffmpeg_path": program}):
                made.save(str(path), writer=FFMpegWriter(fps=rate), dpi=DOTS)


def ffmpeg() -> str:
    """The program that writes MP4: as installed, or that of the package imageio-ffmpeg. Raises BadInput."""
    found = shutil.which("ffmpeg")
    if found is not None:
        return found
    try:
        return str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise BadInput(
            "--to mp4 needs the program ffmpeg: install it, or `pip install imageio-ffmpeg`; gif and svg need nothing"
        ) from None


def _stage(panel: Axes, shown: Shown, theme: Theme) -> list[tuple[Line2D, Array, Array]]:
    """The lines that move: (line, its points in the body's frame, the body's poses)."""
    style_axes(panel, theme, grid=False)
    panel.set_axis_off()
    panel.set_aspect("equal")
    left, bottom, width, height = drawn.box(shown.mechanism, shown.take, shown.truth.pose)
    panel.set_xlim(left, left + width)
    panel.set_ylim(bottom, bottom + height)
    for fixed in drawn.ground_lines(shown.mechanism, shown.take, shown.truth.pose):
        points = np.vstack([fixed.points, fixed.points[:1]]) if fixed.closed else fixed.points
        panel.plot(*points.T, color=theme.quiet, linewidth=1.0)
    out = []
    looks = [(getattr(theme, role), width) for role, width, _ in LOOKS[: len(shown.motions)]] + [(theme.ink, 2.0)]
    for (colour, thick), pose in zip(looks, [*shown.motions.values(), shown.truth.pose], strict=True):
        for index, body in enumerate(shown.mechanism.bodies):
            for each in drawn.body_lines(shown.mechanism, shown.take, body.name):
                points = np.vstack([each.points, each.points[:1]]) if each.closed else each.points
                (line,) = panel.plot([], [], color=colour, linewidth=0.6 * thick, solid_capstyle="round")
                out.append((line, points, pose[:, index]))
    return out


def _chart(panel: Axes, shown: Shown, theme: Theme) -> list[tuple[Line2D, Array]]:
    """The lines of errors that grow: (line, error at every instant [rad])."""
    style_axes(panel, theme)
    panel.set_yscale("log")
    panel.set_xlim(shown.t[0], shown.t[-1])
    panel.set_xlabel("time [s]")
    panel.set_title("largest error of an angle [rad]", fontsize=9, color=theme.ink, loc="left")
    out: list[tuple[Line2D, Array]] = []
    for (role, _, dash), (name, pose) in zip(LOOKS, shown.motions.items(), strict=False):
        error = np.abs(pose - shown.truth.pose)[..., 2].max(axis=1)
        error = np.where(error > 0, error, np.nan)
        style = (0, tuple(float(part) / 2 for part in dash.split())) if dash else "-"
        (line,) = panel.plot([], [], color=getattr(theme, role), linewidth=1.6, linestyle=style, label=name)
        out.append((line, error))
    low, high = decades([error for _, error in out])
    panel.set_ylim(10.0**low, 10.0**high)
    if out:
        panel.legend(fontsize=7.5, labelcolor=theme.ink, facecolor=theme.paper, edgecolor=theme.grid)
    return out
