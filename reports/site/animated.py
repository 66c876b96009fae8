"""A motion that moves: as an SVG whose lines move by rules of style, no script, and as a film of the same picture."""

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
Moving = list[tuple[Line2D, Array, Array]]  # lines, their points in the body's frame (points, 2), its poses (times, 3)
Growing = list[tuple[Line2D, Array]]  # lines, and the error at every instant [rad]

FRAMES = 100  # of a moving picture, at most: what an eye can tell in six seconds
SECONDS = 8.0  # one round
PAUSE = 0.12  # of a round of an SVG, at its end
KEYS = 60  # instants of an SVG that are told apart; between them the pose goes steadily
RATE = 25  # frames a second, of a film; a GIF's frames last whole hundredths of a second, as these do
INCHES = (12.8, 5.6)
DOTS = 100  # an inch of a film: 1280 points wide
# Width of motions [pt], and their lines, whose dashes are told in the widths of lines.
LOOKS: tuple[tuple[float, Any], ...] = (
    (5.6, "-"),
    (4.0, (0, (5, 2.5))),
    (3.2, (0, (1.5, 2.5))),
    (3.2, (0, (6, 2, 1, 2))),
)
DECADES = 8  # of the scale of errors, at most


@dataclass(frozen=True)
class Take(Look):
    """One motion that a picture shows: the truth of a scene, and methods over it.

    methods: (how it is called in the legend, engine, steps between samples). samples: of the scene unless given.
    """

    scene: Scene
    methods: tuple[tuple[str, Engine, int], ...] = ()
    samples: int | None = None

    @property
    def sample_count(self) -> int:
        """Sampling intervals of the motion."""
        return self.scene.samples if self.samples is None else self.samples

    def motions(self) -> dict[str, Motion]:
        """What has to be run for it, by the word of the legend."""
        return {
            word: Motion(Cell(self.scene, engine, every, "failure", self.samples))
            for word, engine, every in self.methods
        }

    @property
    def shown(self) -> slice:
        """The samples that the picture shows: at most about FRAMES."""
        return slice(0, None, max(1, -(-(self.sample_count + 1) // (FRAMES + 1))))


@dataclass(frozen=True)
class Shown:
    """A take with its motions: what pictures are made of."""

    take: Take
    mechanism: Mechanism
    t: Array  # (frames,) s
    truth: Trajectory
    motions: Mapping[str, Array]  # legend -> poses (frames, bodies, 3), NaN where the method gave up
    lost: Mapping[str, str]  # legend -> why there is no motion


def shown(take: Take, answers: Mapping[Any, Answer]) -> Shown:
    """The take at its frames. A method that was not run, or did not finish, is told in `lost`."""
    motions: dict[str, Array] = {}
    lost: dict[str, str] = {}
    spacing = take.scene.duration / take.sample_count
    t = np.arange(take.sample_count + 1, dtype=np.float64)[take.shown] * np.float64(spacing)
    for word, motion in take.motions().items():
        answer = answers.get(motion)
        if answer is None or not answer.finished:
            lost[word] = "not run" if answer is None else f"{answer.outcome}: {answer.sentence}".rstrip(": ")
        else:
            motions[word] = trajectory_of(answer).pose[take.shown]
    return Shown(take, take.scene.mechanism(), t, take.scene.motion(t), motions, lost)


def animation(shown: Shown, title: str) -> str:
    """The whole SVG; the same bytes for the same motions. Without motion it shows the first instant."""
    keys = np.unique(np.linspace(0, len(shown.t) - 1, KEYS).round().astype(int))
    with settings():
        figure, moving, growing = _figure(shown, title, LIGHT, 72)  # the units of matplotlib's SVG
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
    """The rules that move what is called label-... from its first place to the others: (keys, 3), x, y [pt], angle
    [degrees]. Where the method gave up it stays as it was last.
    """
    told = []
    x0, y0, first = last = places[0]
    for index, where in enumerate(places):
        x, y, angle = last = where if np.all(np.isfinite(where)) else last
        share = 100 * (1 - PAUSE) * index / (len(places) - 1)
        told.append(
            f"{share:.2f}%{{transform:translate({drawn.number(x - x0, 2)}px,{drawn.number(y - y0, 2)}px) "
            f"rotate({drawn.number(angle - first, 2)}deg)}}"
        )
    told.append(f"100%{told[-1].partition('%')[2]}")
    origin = f"{drawn.number(x0, 2)}px {drawn.number(y0, 2)}px"
    rule = f"animation:{label} {SECONDS:g}s linear infinite;transform-origin:{origin}"
    return f'@keyframes {label}{{{"".join(told)}}}[id^="{label}-"]{{{rule}}}'


def _looks(shown: Shown, theme: Theme) -> list[tuple[str, float, Any]]:
    """Colour, width and line of each motion: an engine's colour is that of all charts, variants differ by lines."""
    roles = [role(family_of(engine.name)) for words, engine, _ in shown.take.methods if words in shown.motions]
    return [(getattr(theme, own), *look) for own, look in zip(roles, LOOKS, strict=False)]


def decades(errors: Sequence[Array]) -> tuple[int, int]:
    """The powers of ten between which errors are drawn: those of most instants of each method."""
    positive = [error[np.isfinite(error) & (error > 0)] for error in errors]
    positive = [error for error in positive if len(error)] or [np.ones(1)]
    high = int(np.ceil(np.log10(max(error.max() for error in positive))))
    least = min(float(np.quantile(error, 0.15)) for error in positive)
    return min(high - 1, max(int(np.floor(np.log10(least))), high - DECADES)), high


def film(shown: Shown, title: str, path: Path, theme: Theme = LIGHT) -> None:
    """Write the film to a path that ends in .gif or .mp4. Raises BadInput where ffmpeg is needed and not there."""
    program = ffmpeg() if path.suffix == ".mp4" else "ffmpeg"
    with settings(), rc_context({"animation.ffmpeg_path": program}):
        figure, moving, growing = _figure(shown, title, theme, DOTS)
        FigureCanvasAgg(figure)

        def draw(frame: float) -> list[Line2D]:
            """A pose between two samples is between theirs."""
            before, share = int(frame), frame % 1
            after = min(before + 1, len(shown.t) - 1)
            for line, points, pose in moving:
                now = pose[before] + share * (pose[after] - pose[before])
                line.set_data(*(rotated(now[2], points) + now[:2]).T)
            for line, error in growing:
                line.set_data(shown.t[: after + 1], error[: after + 1])
            return []

        frames = np.linspace(0, len(shown.t) - 1, int(RATE * SECONDS)).tolist()
        writer = FFMpegWriter(fps=RATE) if path.suffix == ".mp4" else PillowWriter(fps=RATE)
        try:
            FuncAnimation(figure, draw, frames).save(path, writer)
        except CalledProcessError as reason:
            raise OSError(f"ffmpeg ended with status {reason.returncode}") from None


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


def _figure(shown: Shown, title: str, theme: Theme, dots: int) -> tuple[Figure, Moving, Growing]:
    """The mechanism beside its errors, with the lines that move and those that grow."""
    figure = Figure(figsize=INCHES, dpi=dots, facecolor=theme.paper, layout="constrained")
    stage, chart = figure.subplots(1, 2, width_ratios=(1.2, 1))
    figure.suptitle(title, fontsize=15, color=theme.ink, x=0.02, ha="left")
    return figure, _stage(stage, shown, theme), _chart(chart, shown, theme)


def _stage(panel: Axes, shown: Shown, theme: Theme) -> Moving:
    style_axes(panel, theme, grid=False)
    panel.set_axis_off()
    panel.set_aspect("equal")
    left, bottom, width, height = drawn.box(shown.mechanism, shown.take, shown.truth.pose)
    panel.set_xlim(left, left + width)
    panel.set_ylim(bottom, bottom + height)
    for fixed in drawn.ground_lines(shown.mechanism, shown.take, shown.truth.pose):
        panel.plot(*fixed.outline.T, color=theme.quiet, linewidth=1.0)
    out: Moving = []
    looks = [*_looks(shown, theme), (theme.ink, 1.6, "-")]
    poses = [*shown.motions.values(), shown.truth.pose]
    for motion, ((colour, width, _), pose) in enumerate(zip(looks, poses, strict=True)):
        for index, body in enumerate(shown.mechanism.bodies):
            lines = [each.outline for each in drawn.body_lines(shown.mechanism, shown.take, body.name)]
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
        panel.plot([], [], linewidth=3.0, label=name, **look)  # for the legend, which stands still
        out.append((line, error))
    low, high = decades([error for _, error in out])
    panel.set_ylim(10.0**low, 10.0**high)
    panel.plot([], [], color=theme.ink, linewidth=2.0, label="the exact motion")
    panel.figure.legend(fontsize=11, loc="outside lower right", ncols=2, labelcolor=theme.ink)
    return out
