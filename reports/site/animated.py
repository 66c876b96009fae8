"""Animations of a motion as an SVG with CSS animations or as a film."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from engines import Engine
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.ending import BadInput
from reports.model.tasks import Answer, Motion, trajectory_of
from reports.plots.looks import family_of, role
from reports.plots.theme import LIGHT, Theme, settings, style_axes, svg
from reports.site import drawn
from reports.site.live.sliders import Look

Array = NDArray[np.float64]
# A line, its points in the frame of its body (points, 2), and the body's poses (times, 3).
Moving = list[tuple[Line2D, Array, Array]]
Growing = list[tuple[Line2D, Array]]  # A line, and the error at each time [rad].

FRAMES = 100  # Approximate upper bound of the number of samples in an animation.
SECONDS = 8.0  # Duration of one repetition.
PAUSE = 0.12  # Pause of an SVG before it is repeated, as a fraction of SECONDS.
KEYS = 60  # Number of key frames of an SVG. The browser interpolates linearly between key frames.
RATE = 25  # Frames per second of a film. In a GIF the duration of a frame must be a multiple of 0.01 s.
INCHES = (12.8, 5.6)
DOTS = 100  # Pixels per inch of a film.
# Line width [pt] and dashes (in multiples of the width) of each motion.
LOOKS: tuple[tuple[float, Any], ...] = (
    (5.6, "-"),
    (4.0, (0, (5, 2.5))),
    (3.2, (0, (1.5, 2.5))),
    (3.2, (0, (6, 2, 1, 2))),
)
DECADES = 8  # largest number of decades of the error axis


@dataclass(frozen=True)
class Take(Look):
    """A picture of the exact motion of a scene and of the motions of several methods.

    methods: triples (label, engine, steps between samples). samples: number of sampling intervals, or None for that of
    the scene.
    """

    scene: Scene
    methods: tuple[tuple[str, Engine, int], ...] = ()
    samples: int | None = None

    @property
    def sample_count(self) -> int:
        return self.scene.samples if self.samples is None else self.samples

    def motions(self) -> dict[str, Motion]:
        return {
            label: Motion(Cell(self.scene, engine, every, "failure", self.samples))
            for label, engine, every in self.methods
        }

    @property
    def shown(self) -> slice:
        """The samples in the picture; their number is at most about FRAMES."""
        return slice(0, None, max(1, -(-(self.sample_count + 1) // (FRAMES + 1))))


@dataclass(frozen=True)
class Shown:
    """The motions of `take` at the times of an animation."""

    take: Take
    mechanism: Mechanism
    t: Array  # (frames,) s
    truth: Trajectory
    motions: Mapping[str, Array]  # Label -> poses (frames, bodies, 3), which are NaN after the method has failed.
    missing: Mapping[str, str]  # Label -> reason.


def shown(take: Take, answers: Mapping[Any, Answer]) -> Shown:
    """Return the motions of a take. `missing` contains the methods without a stored motion."""
    motions: dict[str, Array] = {}
    missing: dict[str, str] = {}
    spacing = take.scene.duration / take.sample_count
    t = np.arange(take.sample_count + 1, dtype=np.float64)[take.shown] * np.float64(spacing)
    for label, motion in take.motions().items():
        answer = answers.get(motion)
        if answer is None or not answer.finished:
            missing[label] = "not run" if answer is None else f"{answer.outcome}: {answer.sentence}".rstrip(": ")
        else:
            motions[label] = trajectory_of(answer).pose[take.shown]
    return Shown(take, take.scene.mechanism(), t, take.scene.motion(t), motions, missing)


def animation(shown: Shown, title: str) -> str:
    """Return an animated SVG. A reader without animations sees the first frame."""
    keys = np.unique(np.linspace(0, len(shown.t) - 1, KEYS).round().astype(int))
    with settings():
        figure, moving, growing = _figure(shown, title, LIGHT, 72)  # matplotlib's SVG has 72 points per inch
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        rules = {}
        for line, points, pose in moving:
            line.set_data(*(rotated(pose[0, 2], points) + pose[0, :2]).T)
            line.set_clip_on(False)
            label = str(line.get_gid()).partition("-")[0]
            places = figure.axes[0].transData.transform(pose[keys, :2]) * (1, -1) + (0, figure.bbox.height)
            rules[label] = _keyframes(label, np.column_stack([places, -np.degrees(pose[keys, 2])]))
        for index, (line, error) in enumerate(growing):
            line.set_data(shown.t, error)
            line.set_gid(f"error{index}")
        text = svg(figure, title)
    end = f"{100 * (1 - PAUSE):.2f}%"
    grow = (
        f"@keyframes grow{{0%{{clip-path:inset(-9px 100% -9px 0)}}{end},100%{{clip-path:inset(-9px 0)}}}}"
        f'[id^="error"]{{animation:grow {SECONDS:g}s linear infinite}}'
    )
    moved = f"<style>@media (prefers-reduced-motion: no-preference) {{{grow}{''.join(rules.values())}}}</style>"
    return text.replace("</svg>", moved + "</svg>")


def _keyframes(label: str, places: Array) -> str:
    """Return the CSS that moves the elements with the id `label-...` through `places` (keys, 3).

    The columns of `places` are x, y [pt] and the angle [degrees]. A place that is not finite is replaced by the place
    before it.
    """
    frames = []
    x0, y0, first = last = places[0]
    for index, place in enumerate(places):
        x, y, angle = last = place if np.all(np.isfinite(place)) else last
        share = 100 * (1 - PAUSE) * index / (len(places) - 1)
        frames.append(
            f"{share:.2f}%{{transform:translate({drawn.number(x - x0, 2)}px,{drawn.number(y - y0, 2)}px) "
            f"rotate({drawn.number(angle - first, 2)}deg)}}"
        )
    frames.append(f"100%{frames[-1].partition('%')[2]}")
    origin = f"{drawn.number(x0, 2)}px {drawn.number(y0, 2)}px"
    rule = f"animation:{label} {SECONDS:g}s linear infinite;transform-origin:{origin}"
    return f'@keyframes {label}{{{"".join(frames)}}}[id^="{label}-"]{{{rule}}}'


def _looks(shown: Shown, theme: Theme) -> list[tuple[str, float, Any]]:
    """The colour, width and dashes of each motion. Engines have different colours."""
    roles = [role(family_of(engine.name)) for label, engine, _ in shown.take.methods if label in shown.motions]
    return [(getattr(theme, colour), *look) for colour, look in zip(roles, LOOKS, strict=False)]


def decades(errors: Sequence[Array]) -> tuple[int, int]:
    """Return the limits of the error axis as powers of ten (low, high). The axis covers most samples of each method."""
    positive = [error[np.isfinite(error) & (error > 0)] for error in errors]
    positive = [error for error in positive if len(error)] or [np.ones(1)]
    high = int(np.ceil(np.log10(max(error.max() for error in positive))))
    least = min(float(np.quantile(error, 0.15)) for error in positive)
    return min(high - 1, max(int(np.floor(np.log10(least))), high - DECADES)), high


def film(shown: Shown, title: str, path: Path, theme: Theme = LIGHT) -> None:
    """Write a film to a path that ends in .gif or .mp4. Raises BadInput if .mp4 is requested without ffmpeg."""
    program = ffmpeg() if path.suffix == ".mp4" else "ffmpeg"
    with settings(), rc_context({"animation.ffmpeg_path": program}):
        figure, moving, growing = _figure(shown, title, theme, DOTS)
        FigureCanvasAgg(figure)

        def draw(frame: float) -> list[Line2D]:
            start, share = int(frame), frame % 1
            end = min(start + 1, len(shown.t) - 1)
            for line, points, pose in moving:
                now = pose[start] + share * (pose[end] - pose[start])
                line.set_data(*(rotated(now[2], points) + now[:2]).T)
            for line, error in growing:
                line.set_data(shown.t[: end + 1], error[: end + 1])
            return []

        frames = np.linspace(0, len(shown.t) - 1, int(RATE * SECONDS)).tolist()
        writer = FFMpegWriter(fps=RATE) if path.suffix == ".mp4" else PillowWriter(fps=RATE)
        try:
            FuncAnimation(figure, draw, frames).save(path, writer)
        except CalledProcessError as reason:
            raise OSError(f"ffmpeg ended with status {reason.returncode}") from None


def ffmpeg() -> str:
    """Return the path of the installed ffmpeg or of that in imageio-ffmpeg. Raises BadInput if both are missing."""
    installed = shutil.which("ffmpeg")
    if installed is not None:
        return installed
    try:
        return str(import_module("imageio_ffmpeg").get_ffmpeg_exe())
    except (ImportError, RuntimeError):
        raise BadInput(
            "--to mp4 needs the program ffmpeg: install it, or `pip install imageio-ffmpeg`; gif and svg need nothing"
        ) from None


def _figure(shown: Shown, title: str, theme: Theme, dots: int) -> tuple[Figure, Moving, Growing]:
    """Return the figure, the lines that move, and the lines that grow."""
    figure = Figure(figsize=INCHES, dpi=dots, facecolor=theme.paper, layout="constrained")
    stage, chart = figure.subplots(1, 2, width_ratios=(1.2, 1))
    figure.suptitle(title, fontsize=15, color=theme.ink, x=0.02, ha="left")
    return figure, _stage(stage, shown, theme), _chart(chart, shown, theme)


def _stage(panel: Axes, shown: Shown, theme: Theme) -> Moving:
    style_axes(panel, theme, grid=False)
    panel.set_axis_off()
    panel.set_aspect("equal")
    x, y, width, height = drawn.box(shown.mechanism, shown.take, shown.truth.pose)
    panel.set_xlim(x, x + width)
    panel.set_ylim(y, y + height)
    for fixed in drawn.ground_lines(shown.mechanism, shown.take, shown.truth.pose):
        panel.plot(*fixed.outline.T, color=theme.quiet, linewidth=1.0)
    out: Moving = []
    looks = [*_looks(shown, theme), (theme.ink, 1.6, "-")]
    poses = [*shown.motions.values(), shown.truth.pose]
    for motion, ((colour, width, _), pose) in enumerate(zip(looks, poses, strict=True)):
        for index, body in enumerate(shown.mechanism.bodies):
            lines = [stroke.outline for stroke in drawn.body_lines(shown.mechanism, shown.take, body.name)]
            style: dict[str, Any] = {"color": colour, "linewidth": width, "solid_capstyle": "round"}
            for number, points in enumerate(lines):
                (line,) = panel.plot([], [], gid=f"m{motion}b{index}-{number}", **style)
                out.append((line, points, pose[:, index]))
            if pose is shown.truth.pose and (pins := drawn.pins_of(shown.mechanism, body.name)):
                (line,) = panel.plot([], [], "o", color=colour, mfc=theme.paper, gid=f"m{motion}b{index}-pins")
                out.append((line, np.array(pins), pose[:, index]))
    return out


def _chart(panel: Axes, shown: Shown, theme: Theme) -> Growing:
    style_axes(panel, theme)
    panel.set_yscale("log")
    panel.set_xlim(shown.t[0], shown.t[-1])
    panel.set_xlabel("time [s]", fontsize=12)
    panel.tick_params(labelsize=11)
    panel.set_title("largest error of an angle [rad]", fontsize=12, color=theme.ink, loc="left")
    out: Growing = []
    for (colour, _, line_style), (name, pose) in zip(_looks(shown, theme), shown.motions.items(), strict=True):
        error = np.abs(pose - shown.truth.pose)[..., 2].max(axis=1)
        error = np.where(error > 0, error, np.nan)
        look: dict[str, Any] = {"color": colour, "linestyle": line_style}
        (line,) = panel.plot([], [], linewidth=2.0, **look)
        panel.plot([], [], linewidth=3.0, label=name, **look)  # for the legend
        out.append((line, error))
    low, high = decades([error for _, error in out])
    panel.set_ylim(10.0**low, 10.0**high)
    panel.plot([], [], color=theme.ink, linewidth=2.0, label="the exact motion")
    panel.figure.legend(fontsize=11, loc="outside lower right", ncols=2, labelcolor=theme.ink)
    return out
