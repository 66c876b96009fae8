"""A motion that moves: as an SVG by rules of style, no script, and as a film of frames that matplotlib draws."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from html import escape
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray
from PIL import Image

from reference.plane import rotated
from reports.model.ending import BadInput
from reports.plots.looks import family_of, role
from reports.plots.theme import DARK, FONTS, LIGHT, Theme, settings, style_axes
from reports.site import drawn
from reports.site.embed import Shown

Array = NDArray[np.float64]

SECONDS = 8.0  # one round
PAUSE = 0.12  # of a round, at its end
KEYS = 60  # instants that are told apart; between them the pose goes steadily
WIDTH, HEIGHT = 920.0, 400.0  # px
STAGE = 480.0  # px: the part of the width for the mechanism
TITLE = 44.0  # px
LEFT, RIGHT, TOP, BOTTOM = 560.0, 900.0, 90.0, 316.0  # px: the frame of the errors
LOOKS = (("first", 7.0, ""), ("second", 5.0, "10 5"), ("fourth", 4.0, "3 5"), ("sixth", 4.0, "12 4 2 4"))
SCHEMES = (LIGHT, DARK)
DECADES = 8  # of the scale of errors, at most


def animation(shown: Shown, title: str) -> str:
    """The whole SVG; the same bytes for the same motions."""
    take, mechanism = shown.take, shown.mechanism
    keys = np.unique(np.linspace(0, len(shown.t) - 1, KEYS).round().astype(int))
    left, bottom, width, height = drawn.box(mechanism, take, shown.truth.pose)
    scale = min(STAGE / width, (HEIGHT - TITLE - 12) / height)
    ways = [
        f"translate({drawn.number(20 + (STAGE - 20 - scale * width) / 2 - scale * left, 2)} "
        f"{drawn.number(TITLE + (HEIGHT - TITLE - 12 + scale * height) / 2 + scale * bottom, 2)})",
        f"scale({drawn.number(scale, 3)} {drawn.number(-scale, 3)})",
    ]
    rules: list[str] = []
    groups = []
    moving = [*shown.motions.items(), ("truth", shown.truth.pose)]
    for index, (name, pose) in enumerate(moving):
        bodies = []
        for number, body in enumerate(mechanism.bodies):
            label = f"m{index}b{number}"
            rules.append(_keyframes(label, pose[keys, number]))
            shape = drawn.body_shape(mechanism, take, body.name)
            bodies.append(f'<g style="animation-name:{label}" transform="{drawn.placed(pose[0, number])}">{shape}</g>')
        look = "truth" if name == "truth" else f"k{index}"
        groups.append(f'<g class="{look}">{"".join(bodies)}</g>')
    errors = [(name, np.abs(pose - shown.truth.pose)[..., 2].max(axis=1)) for name, pose in shown.motions.items()]
    return "".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{WIDTH:g}" '
            f'height="{HEIGHT:g}" role="img"><title>{escape(title)}</title>',
            f"<style>{_sheet(roles_of(shown))}{''.join(rules)}</style>",
            f'<rect class="paper" width="{WIDTH:g}" height="{HEIGHT:g}"/>',
            f'<text class="title" x="20" y="30">{escape(title)}</text>',
            f'<clipPath id="own"><rect width="{STAGE + 20:g}" height="{HEIGHT:g}"/></clipPath>',
            f'<g clip-path="url(#own)"><g class="stage" transform="{" ".join(ways)}">',
            f'<g class="fixed">{drawn.ground(mechanism, take, shown.truth.pose)}</g>{"".join(groups)}</g></g>',
            _chart(shown.t, errors),
            "</svg>\n",
        ]
    )


def roles_of(shown: Shown) -> list[str]:
    """The colour of each motion: that of its engine, as in all charts; variants differ by their lines."""
    engines = {words: engine.name for words, engine, _ in shown.take.methods}
    usual = zip(shown.motions, LOOKS, strict=False)
    return [role(family_of(engines[name])) if name in engines else other for name, (other, _, _) in usual]


def _keyframes(label: str, pose: Array) -> str:
    """The rule that moves a body through its poses (keys, 3). Where the method gave up it stays as it was last."""
    keys, told = len(pose), []
    last = pose[0]
    for index, where in enumerate(pose):
        last = where if np.all(np.isfinite(where)) else last
        x, y, angle = last
        share = 100 * (1 - PAUSE) * index / (keys - 1)
        told.append(
            f"{share:.2f}%{{transform:translate({drawn.number(x, 4)}px,{drawn.number(y, 4)}px) "
            f"rotate({drawn.number(np.degrees(angle), 2)}deg)}}"
        )
    told.append(f"100%{told[-1].partition('%')[2]}")
    return f"@keyframes {label}{{{''.join(told)}}}"


def _chart(t: Array, errors: Sequence[tuple[str, Array]]) -> str:
    """The errors over time on a logarithmic scale, uncovered as time goes on."""
    low, high = decades([error for _, error in errors])

    def place(power: Array | float) -> Array:
        return TOP + (BOTTOM - TOP) * (high - np.clip(power, low, high)) / (high - low)

    parts = [f'<text x="{LEFT:g}" y="{TOP - 36:g}">largest error of an angle [rad], logarithmic</text>']
    stride = -(-(high - low) // 5)
    for power in range(high, low - 1, -stride):
        y = drawn.number(float(place(power)), 1)
        parts.append(f'<line class="grid" x1="{LEFT:g}" x2="{RIGHT:g}" y1="{y}" y2="{y}"/>')
        parts.append(f'<text class="small end" x="{LEFT - 8:g}" y="{float(y) + 4:g}">1e{power}</text>')
    for share in (0.0, 0.5, 1.0):
        x, text = LEFT + (RIGHT - LEFT) * share, f"{t[0] + share * (t[-1] - t[0]):.3g} s"
        parts.append(f'<text class="small middle" x="{x:g}" y="{BOTTOM + 20:g}">{text}</text>')
    lines, words = [], [_legend(0, "truth", "the exact motion")]
    for index, (name, error) in enumerate(errors):
        with np.errstate(all="ignore"):
            power = np.log10(error)
        seen = np.isfinite(power) & (power >= low)
        x = LEFT + (RIGHT - LEFT) * (t - t[0]) / (t[-1] - t[0])
        path = drawn.path(np.stack([x, place(np.nan_to_num(power))], axis=-1)[seen]) if seen.any() else ""
        lines.append(f'<g class="k{index}"><path class="own" d="{path}"/></g>')
        words.append(_legend(index + 1, f"k{index}", name))
    return (
        f'{"".join(parts)}<g class="shown"><clipPath id="seen"><rect class="cover" x="{LEFT:g}" y="{TOP - 6:g}" '
        f'width="{RIGHT - LEFT + 6:g}" height="{BOTTOM - TOP + 12:g}"/></clipPath>'
        f'<g clip-path="url(#seen)">{"".join(lines)}</g></g>{"".join(words)}'
    )


def decades(errors: Sequence[Array]) -> tuple[int, int]:
    """The powers of ten between which errors are drawn: those of most instants of each method."""
    positive = [error[np.isfinite(error) & (error > 0)] for error in errors]
    positive = [error for error in positive if len(error)] or [np.ones(1)]
    high = int(np.ceil(np.log10(max(error.max() for error in positive))))
    least = min(float(np.quantile(error, 0.15)) for error in positive)
    return min(high - 1, max(int(np.floor(np.log10(least))), high - DECADES)), high


def _legend(index: int, look: str, name: str) -> str:
    x, y = LEFT - 20 + 190 * (index % 2), BOTTOM + 40 + 20 * (index // 2)
    return (
        f'<g class="{look}"><line class="own" x1="{x:g}" x2="{x + 26:g}" y1="{y - 4:g}" y2="{y - 4:g}"/></g>'
        f'<text class="small" x="{x + 32:g}" y="{y:g}">{escape(name)}</text>'
    )


def _sheet(roles: Sequence[str]) -> str:
    """The style: light and dark, and no motion where none is asked for."""
    names = ("paper", "ink", "quiet", "grid", *dict.fromkeys(roles))
    light, dark = ("".join(f"--{name}:{getattr(theme, name)};" for name in names) for theme in SCHEMES)
    looks = "".join(
        f".k{index} path,.k{index} line{{stroke:var(--{role});stroke-width:{width:g};"
        f"stroke-dasharray:{dash or 'none'}}}"
        f".k{index} .own{{stroke-width:2.5}}.k{index} .pin{{stroke:none}}"
        for index, (role, (_, width, dash)) in enumerate(zip(roles, LOOKS, strict=False))
    )
    rules = (
        f"text{{font:14px {FONTS};fill:var(--ink)}}.title{{font-size:17px;font-weight:bold}}.small{{font-size:12px}}"
        ".end{text-anchor:end}.middle{text-anchor:middle}.paper{fill:var(--paper)}.grid{stroke:var(--grid)}"
        "path,line,circle{fill:none;vector-effect:non-scaling-stroke}"
        ".fixed path{stroke:var(--quiet);stroke-width:1.4}.fixed .support{fill:var(--grid)}"
        ".truth path,.truth line,.truth .pin{stroke:var(--ink);stroke-width:2}.truth .pin{fill:var(--paper)}"
        f"{looks}"
    )
    # A viewer that knows no variables leaves out what names one, and takes the light colour that stands before it.
    rules = re.sub(
        r"(fill|stroke):var\(--(\w+)\)", lambda found: f"{found[1]}:{getattr(LIGHT, found[2])};{found[0]}", rules
    )
    return (
        f":root{{{light}}}@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"
        f"{rules}"
        f".stage g g,.cover{{animation:{SECONDS:g}s linear infinite}}"
        ".cover{animation-name:cover;transform-origin:0 0}"
        f"@keyframes cover{{0%{{transform:translate({LEFT:g}px) scaleX(0) translate(-{LEFT:g}px)}}"
        f"{100 * (1 - PAUSE):.2f}%,100%{{transform:translate({LEFT:g}px) scaleX(1) translate(-{LEFT:g}px)}}}}"
        "@media(prefers-reduced-motion:reduce){.stage g g,.cover{animation:none}}"
    )


RATE = 25  # frames a second, of a film; a GIF's frames last whole hundredths of a second, as these do
INCHES = (12.8, 5.6)
DOTS = 100  # an inch: 1280 points wide


def film(shown: Shown, title: str, path: Path, theme: Theme = LIGHT) -> None:
    """Write the film to a path that ends in .gif or .mp4. Raises BadInput where ffmpeg is needed and not there."""
    program = ffmpeg() if path.suffix == ".mp4" else None
    frames = np.linspace(0, len(shown.t) - 1, int(RATE * SECONDS))
    with settings():
        figure = Figure(figsize=INCHES, dpi=DOTS, facecolor=theme.paper, layout="constrained")
        canvas = FigureCanvasAgg(figure)
        stage, chart = figure.subplots(1, 2, width_ratios=(1.2, 1))
        figure.suptitle(title, fontsize=15, color=theme.ink, x=0.02, ha="left")
        moving = _film_stage(stage, shown, theme)
        growing = _film_chart(chart, shown, theme)
        canvas.draw()
        figure.set_layout_engine("none")  # once is enough: the panels stay where they are
        still = canvas.copy_from_bbox(figure.bbox)

        def picture(frame: float) -> Image.Image:
            """What stands still is drawn once; a pose between two samples is between theirs."""
            canvas.restore_region(still)
            before, share = int(frame), frame % 1
            after = min(before + 1, len(shown.t) - 1)
            for line, points, pose in moving:
                now = pose[before] + share * (pose[after] - pose[before])
                line.set_data(*(rotated(now[2], points) + now[:2]).T)
                stage.draw_artist(line)
            for line, error in growing:
                line.set_data(shown.t[: after + 1], error[: after + 1])
                chart.draw_artist(line)
            return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])

        pictures = map(picture, frames.tolist())
        if program is None:
            _gif(pictures, path)
        else:
            _mp4(pictures, program, path, canvas.get_width_height())


def _gif(pictures: Iterator[Image.Image], path: Path) -> None:
    """All frames share the colours of the first one that has everything in it, the last."""
    held = list(pictures)
    colours = held[-1].quantize(64, dither=Image.Dither.NONE)
    first, *rest = (each.quantize(palette=colours, dither=Image.Dither.NONE) for each in held)
    first.save(path, save_all=True, append_images=rest, duration=1000 // RATE, loop=0, optimize=False)


def _mp4(pictures: Iterator[Image.Image], program: str, path: Path, size: tuple[int, int]) -> None:
    words = [program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", "{}x{}".format(*size)]
    words += ["-r", str(RATE), "-i", "-", "-pix_fmt", "yuv420p", "-preset", "veryfast", str(path)]
    ended = subprocess.run(words, input=b"".join(each.tobytes() for each in pictures), capture_output=True)
    if ended.returncode:
        raise OSError(f"ffmpeg: {(ended.stderr.decode(errors='replace').strip().splitlines() or ['no reason'])[-1]}")


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


def _film_stage(panel: Axes, shown: Shown, theme: Theme) -> list[tuple[Line2D, Array, Array]]:
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
    widths = (width for _, width, _ in LOOKS)
    looks = [(getattr(theme, own), width) for own, width in zip(roles_of(shown), widths, strict=False)]
    looks.append((theme.ink, 2.0))
    for (colour, thick), pose in zip(looks, [*shown.motions.values(), shown.truth.pose], strict=True):
        for index, body in enumerate(shown.mechanism.bodies):
            for each in drawn.body_lines(shown.mechanism, shown.take, body.name):
                points = np.vstack([each.points, each.points[:1]]) if each.closed else each.points
                (line,) = panel.plot([], [], color=colour, linewidth=0.8 * thick, solid_capstyle="round", animated=True)
                out.append((line, points, pose[:, index]))
    return out


def _film_chart(panel: Axes, shown: Shown, theme: Theme) -> list[tuple[Line2D, Array]]:
    """The lines of errors that grow: (line, error at every instant [rad])."""
    style_axes(panel, theme)
    panel.set_yscale("log")
    panel.set_xlim(shown.t[0], shown.t[-1])
    panel.set_xlabel("time [s]", fontsize=12)
    panel.tick_params(labelsize=11)
    panel.set_title("largest error of an angle [rad]", fontsize=12, color=theme.ink, loc="left")
    out: list[tuple[Line2D, Array]] = []
    for own, (_, _, dash), (name, pose) in zip(roles_of(shown), LOOKS, shown.motions.items(), strict=False):
        error = np.abs(pose - shown.truth.pose)[..., 2].max(axis=1)
        error = np.where(error > 0, error, np.nan)
        style = (0, tuple(float(part) / 2 for part in dash.split())) if dash else "-"
        look: dict[str, Any] = {"color": getattr(theme, own), "linestyle": style}
        (line,) = panel.plot([], [], linewidth=2.0, animated=True, **look)
        panel.plot([], [], linewidth=3.0, label=name, **look)  # for the legend, which stands still
        out.append((line, error))
    low, high = decades([error for _, error in out])
    panel.set_ylim(10.0**low, 10.0**high)
    panel.plot([], [], color=theme.ink, linewidth=2.0, label="the exact motion")
    style_legend = {"labelcolor": theme.ink, "facecolor": theme.paper, "edgecolor": theme.grid}
    panel.legend(fontsize=11, loc="lower right", **style_legend)
    return out
