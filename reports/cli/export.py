"""`crosscheck export SCENE` writes a scene as a file for an engine. `crosscheck view SCENE` shows the scene."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from engines import Unsupported
from engines.loading import Kind, registered_by_key
from reference.scene import Scene
from reports.cli.known import one_scene
from reports.cli.options import REFERENCES, STDOUT, refuse_existing
from reports.cli.streams import written
from reports.model.ending import BadInput, visible
from reports.run.files import is_stream, write_whole
from reports.site.animated import animation, shown
from reports.site.live.scenes import take_like

INSTANTS = 10  # Number of instants of the exact motion in the comments.
WRITER_MEMBERS = ("suffix", "write", "commented")  # Every writer must have these members.

SceneName = Annotated[str, typer.Argument(help=f"A scene's name, or {REFERENCES}.")]
Out = Annotated[Path | None, typer.Option("--out", help="The file; standard output unless given.")]
Force = Annotated[bool, typer.Option("--force", help="Replace a file that is there.")]


def export(
    scene: SceneName,
    to: Annotated[str, typer.Option("--to", help="mjcf, urdf, or the engine whose script it is.")] = "mjcf",
    variant: Annotated[str, typer.Option(help="The variant whose settings the file has.")] = "default",
    step: Annotated[float, typer.Option(help="The step in the file [s].")] = 1e-3,
    out: Out = None,
    force: Force = False,
) -> None:
    """Write a scene as a file that runs without this suite, with the truth at ten instants in its comments."""
    known = writers()
    if to not in known:
        raise BadInput(f"--to is {to!r}; it must be one of {', '.join(sorted(known))}")
    if not 0 < step < float("inf"):
        raise BadInput(f"--step is {step:g}; it must be a finite time above zero")
    chosen = one_scene(scene)[1]
    try:
        text = known[to].write(chosen.mechanism(), step, variant)
    except (Unsupported, ValueError) as reason:
        raise BadInput(f"{chosen.name}: {reason}") from None
    comments = [*truth_lines(chosen), f"Settings of the variant {variant!r}, with a step of {step:g} s."]
    _write(out or STDOUT, known[to].commented(text, comments), force)


def view(
    scene: SceneName,
    variant: Annotated[str, typer.Option(help="The variant that the viewer steps.")] = "default",
    out: Annotated[Path | None, typer.Option("--out", help="An animation in this file (.svg), and no viewer.")] = None,
    force: Force = False,
) -> None:
    """Look at a scene: in an engine's viewer where there is a display, or else as an animation in a file."""
    _, chosen = one_scene(scene)
    if out is None:
        try:
            for show in _registered("viewer", lambda value: "" if callable(value) else "it is none").values():
                show(writers()["mjcf"].write(chosen.mechanism(), 1e-3, variant))
                return
        except Unsupported as reason:
            print(f"no viewer: {reason}")
        except ValueError as reason:
            raise BadInput(f"{chosen.name}: {reason}") from None
        out = Path(f"{chosen.name}.svg")
    motion = shown(take_like(chosen, ()), {})
    _write(out, animation(motion, f"{chosen.name.replace('_', ' ')}: the exact motion"), force)


def writers() -> dict[str, Any]:
    """Value of --to -> writer, from the entry point group `crosscheck.writers`."""
    lacking = f"it lacks {', '.join(WRITER_MEMBERS)}"
    return _registered("writer", lambda value: "" if all(hasattr(value, name) for name in WRITER_MEMBERS) else lacking)


def _registered(name: str, trouble: Callable[[Any], str]) -> dict[str, Any]:
    return registered_by_key(f"crosscheck.{name}s", Kind(name, trouble))


def truth_lines(scene: Scene) -> list[str]:
    """Lines of comments with the exact poses of all bodies at INSTANTS instants."""
    mechanism = scene.mechanism()
    times = np.linspace(0.0, scene.duration, INSTANTS)
    x, y = mechanism.gravity
    lines = [
        f"{scene.name} ({scene.source}): where the centres of mass are [m], and the angles [rad], in truth.",
        f"Gravity: {x:.12g}, {y:.12g} m/s^2 in the plane, x and y as below; some formats can't hold it.",
    ]
    for t, poses in zip(times, scene.motion(times).pose, strict=True):
        lines.append(f"t = {t:.6g} s")
        lines += [
            f"    {body.name}: x {x:.12g}, y {y:.12g}, angle {angle:.12g}"
            for body, (x, y, angle) in zip(mechanism.bodies, poses, strict=True)
        ]
    return lines


def _write(path: Path, text: str, force: bool) -> None:
    if path == STDOUT:
        with written():
            print(text, end="")
        return
    refuse_existing([path], "--out", force)
    write_whole({path: text}, "give another --out")
    if not is_stream(path):  # Standard output must contain only the text.
        print(visible(f"written: {path}"))
