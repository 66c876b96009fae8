"""A motion as an SVG that moves by itself: the truth, methods over it, and their errors as they grow.

It is moved by rules of style, no script: so it moves in a README as well, and stands still for who asks for no motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from reports.plots.theme import DARK, FONTS, LIGHT
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
            f"<style>{_sheet()}{''.join(rules)}</style>",
            f'<rect class="paper" width="{WIDTH:g}" height="{HEIGHT:g}"/>',
            f'<text class="title" x="20" y="30">{escape(title)}</text>',
            f'<clipPath id="own"><rect width="{STAGE + 20:g}" height="{HEIGHT:g}"/></clipPath>',
            f'<g clip-path="url(#own)"><g class="stage" transform="{" ".join(ways)}">',
            f'<g class="fixed">{drawn.ground(mechanism, take, shown.truth.pose)}</g>{"".join(groups)}</g></g>',
            _chart(shown.t, errors),
            "</svg>\n",
        ]
    )


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


def _sheet() -> str:
    """The style: light and dark, and no motion where none is asked for."""
    names = ("paper", "ink", "quiet", "grid", *(role for role, _, _ in LOOKS))
    light, dark = ("".join(f"--{name}:{getattr(theme, name)};" for name in names) for theme in SCHEMES)
    looks = "".join(
        f".k{index} path,.k{index} line{{stroke:var(--{role});stroke-width:{width:g};"
        f"stroke-dasharray:{dash or 'none'}}}"
        f".k{index} .own{{stroke-width:2.5}}.k{index} .pin{{stroke:none}}"
        for index, (role, width, dash) in enumerate(LOOKS)
    )
    return (
        f":root{{{light}}}@media(prefers-color-scheme:dark){{:root{{{dark}}}}}"
        f"text{{font:14px {FONTS};fill:var(--ink)}}.title{{font-size:17px;font-weight:bold}}.small{{font-size:12px}}"
        ".end{text-anchor:end}.middle{text-anchor:middle}.paper{fill:var(--paper)}.grid{stroke:var(--grid)}"
        "path,line,circle{fill:none;vector-effect:non-scaling-stroke}"
        ".fixed path{stroke:var(--quiet);stroke-width:1.4}.fixed .support{fill:var(--grid)}"
        ".truth path,.truth line,.truth .pin{stroke:var(--ink);stroke-width:2}.truth .pin{fill:var(--paper)}"
        f"{looks}"
        f".stage g g,.cover{{animation:{SECONDS:g}s linear infinite}}"
        ".cover{animation-name:cover;transform-origin:0 0}"
        f"@keyframes cover{{0%{{transform:translate({LEFT:g}px) scaleX(0) translate(-{LEFT:g}px)}}"
        f"{100 * (1 - PAUSE):.2f}%,100%{{transform:translate({LEFT:g}px) scaleX(1) translate(-{LEFT:g}px)}}}}"
        "@media(prefers-reduced-motion:reduce){.stage g g,.cover{animation:none}}"
    )
