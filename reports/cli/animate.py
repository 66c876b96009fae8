"""`crosscheck animate SCENE`: an animation of the exact motion and of the motions of engines."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from engines import Engine
from engines.registry import method_name
from reports.cli.known import one_scene
from reports.cli.options import FOLDER, REFERENCES, STORE, Folder, Settings, listed, refuse_existing
from reports.cli.run import run_interruptible
from reports.cli.terminal import Terminal, opened
from reports.model.ending import BadInput, FileTrouble
from reports.run.files import folder_for, is_stream, temporary_folder, write_whole
from reports.site.animated import Shown, animation, ffmpeg, film, shown
from reports.site.live.scenes import take_like
from reports.write.tables import number

KINDS = ("svg", "gif", "mp4")
MOST_SHOWN = 4  # More methods in one picture could not be distinguished.


def animate(
    scene: Annotated[str, typer.Argument(help=f"A scene by name, or {REFERENCES}.")],
    engines: Annotated[
        list[str] | None,
        typer.Option(help="Methods by name, such as 'mujoco tuned,pymunk tuned'; those as shipped unless given."),
    ] = None,
    to: Annotated[str, typer.Option(help="svg (moves without a script), gif, or mp4 (needs ffmpeg).")] = "svg",
    every: Annotated[int, typer.Option(min=1, max=2**31 - 1, help="Steps between samples.")] = 1,
    output: Annotated[Path | None, typer.Option(help="The file; SCENE.svg, .gif or .mp4 unless given.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a file that is there.")] = False,
    settings: Settings = None,
    results: Folder = FOLDER,
) -> None:
    """Write an animation of the exact motion and of the motions of engines, with their errors over time."""
    if to not in KINDS:
        raise BadInput(f"--to is {to!r}; there are {', '.join(KINDS)}")
    known, chosen = one_scene(scene, settings or ())
    methods = _methods(engines, known.engines)
    path = output or Path(f"{chosen.name}.{to}")
    _refuse_bad(path, to, force)
    take = take_like(chosen, tuple((method_name(engine), engine, every) for engine in methods))
    motions = tuple(take.motions().values())
    terminal = Terminal(140)
    with opened(results / STORE) as store:
        run_interruptible(terminal, store, motions, fresh=False, limit=60.0)
        picture = shown(take, dict(store.answers(motions)))
    for label, why in picture.missing.items():
        terminal.say(f"{label}: {why}")
    _write(picture, to, path)
    if not is_stream(path):
        terminal.say(f"written: {path}, {path.stat().st_size / 1000:.0f} kB")


def _methods(words: list[str] | None, engines: tuple[Engine, ...]) -> list[Engine]:
    if words is None:
        return [engine for engine in engines if engine.variant == "default"][:MOST_SHOWN]
    known = {method_name(engine): engine for engine in engines}
    names = listed("--engines", words, known)
    if len(names) > MOST_SHOWN:
        raise BadInput(
            f"--engines names {len(names)} methods; more than {MOST_SHOWN} can't be told apart in one picture"
        )
    return [known[name] for name in names]


def _refuse_bad(path: Path, kind: str, force: bool) -> None:
    refuse_existing([path], "--output", force)
    if kind == "mp4":
        ffmpeg()
    if is_stream(path) and kind != "svg":
        raise BadInput(f"--output {path} is no file, and a film has to be one")
    if not is_stream(path) and path.suffix != f".{kind}":
        raise BadInput(f"--output is {str(path)!r}; with --to {kind} it must end in .{kind}")
    folder_for(path.absolute().parent, "give another --output")


def _write(picture: Shown, kind: str, path: Path) -> None:
    take = picture.take
    title = f"{take.scene.name.replace('_', ' ')}: the exact motion"
    if take.methods:
        title += f", and engines at a step of {number(take.scene.spacing / take.methods[0][2])} s"
    if kind == "svg":
        write_whole({path: animation(picture, title)}, "give another --output")
        return
    try:
        with temporary_folder(path.absolute().parent) as aside:
            film(picture, title, aside / path.name)
            (aside / path.name).replace(path)
    except OSError as reason:
        raise FileTrouble(f"{path} can't be written ({reason.strerror or reason}): give another --output") from None
