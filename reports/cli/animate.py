"""`crosscheck animate SCENE`: the exact motion and engines over it, as a picture that moves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.options import FOLDER, REFERENCES, STORE, Folder, Settings, listed, refuse_existing
from reports.model.ending import BadInput, FileTrouble

if TYPE_CHECKING:
    from engines import Engine
    from reference.scene import Scene
    from reports.site.animated import Shown

KINDS = ("svg", "gif", "mp4")
MOST = 4  # methods in one picture: more can't be told apart


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
    """Write a picture that moves: the exact motion, what engines make of it, and how their errors grow."""
    if to not in KINDS:
        raise BadInput(f"--to is {to!r}; there are {', '.join(KINDS)}")
    from reports.cli.known import one_scene
    from reports.run.files import folder_for, is_stream

    known, chosen = one_scene(scene, settings or ())
    methods = _methods(engines, known.engines)
    path = output or Path(f"{chosen.name}.{to}")
    refuse_existing([path], "--output", force)
    if to == "mp4":
        from reports.site.animated import ffmpeg

        ffmpeg()  # refused before anything is run
    stream = is_stream(path)
    if stream and to != "svg":
        raise BadInput(f"--output {path} is no file, and a film has to be one")
    if not stream and path.suffix != f".{to}":
        raise BadInput(f"--output is {str(path)!r}; with --to {to} it must end in .{to}")
    folder_for(path.absolute().parent, "give another --output")  # before anything is run
    shown = _shown(chosen, methods, every, results)
    from reports.cli.terminal import Terminal

    for word, why in shown.lost.items():
        Terminal(140).say(f"{word}: {why}")
    _write(shown, to, path)
    if not stream:
        Terminal(140).say(f"written: {path}, {path.stat().st_size / 1000:.0f} kB")


def _methods(words: list[str] | None, engines: tuple[Engine, ...]) -> list[Engine]:
    """The engines of these names. Raises BadInput for one that is not known, and for too many."""
    from engines.registry import method_name

    if words is None:
        return [engine for engine in engines if engine.variant == "default"][:MOST]
    known = {method_name(engine): engine for engine in engines}
    names = listed("--engines", words, known)
    if len(names) > MOST:
        raise BadInput(f"--engines names {len(names)} methods; more than {MOST} can't be told apart in one picture")
    return [known[name] for name in names]


def _shown(scene: Scene, engines: list[Engine], every: int, results: Path) -> Shown:
    """The motions, those that are not stored run by the pool first."""
    from engines.registry import method_name
    from reports.cli.run import run_interruptible
    from reports.cli.terminal import Terminal, opened
    from reports.site.animated import shown
    from reports.site.lessons import take_like

    take = take_like(scene, tuple((method_name(engine), engine, every) for engine in engines))
    motions = tuple(take.motions().values())
    with opened(results / STORE) as store:
        run_interruptible(Terminal(140), store, motions, fresh=False, limit=60.0)
        return shown(take, dict(store.answers(motions)))


def _write(shown: Shown, kind: str, path: Path) -> None:
    from reports.run.files import temporary_folder, write_whole
    from reports.site.animated import animation, film
    from reports.write.tables import number

    take = shown.take
    step = number(take.scene.spacing / take.methods[0][2]) if take.methods else ""
    title = f"{take.scene.name.replace('_', ' ')}: the exact motion" + (
        f", and engines at a step of {step} s" if step else ""
    )
    if kind == "svg":
        write_whole({path: animation(shown, title)}, "give another --output")
        return
    try:
        with temporary_folder(path.absolute().parent) as aside:
            film(shown, title, aside / path.name)
            (aside / path.name).replace(path)
    except OSError as reason:
        raise FileTrouble(f"{path} can't be written ({reason.strerror or reason}): give another --output") from None
