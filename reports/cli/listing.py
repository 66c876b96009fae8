"""`crosscheck list`: scenes, engines and variants, and what is unsupported, with the reason."""

from __future__ import annotations

from reports.cli.options import EngineName, Scenes, VariantName
from reports.cli.terminal import Terminal, print_table


def list_command(scene: Scenes = None, engine: EngineName = None, variant: VariantName = None) -> None:
    """Scenes, engines and variants, and what is unsupported, with the reason."""
    from engines.registry import ENGINES, INSTALLED, method
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_engines, choose_scenes
    from reports.model.catalogue import page_of
    from reports.model.cells import Cell
    from reports.run.running import support

    known, names, given = with_words(registered(), scene or (), engine)
    scenes = choose_scenes(names, known.scenes, known.pages)
    named = given or ((*ENGINES, *INSTALLED) if engine is None else known.engines)
    engines = choose_engines(None if given else engine, variant, named)
    console = Terminal(140)
    taught = {one: page.name if (page := page_of(one, known.pages)) else "" for one in scenes}
    rows = [(one.name, taught[one], one.source, f"{one.duration:.4g}") for one in scenes]
    print_table(console, "Scenes", ["scene", "page", "source", "duration [s]"], rows, 3)
    console.print()
    print_table(
        console, "Engines", ["engine", "variant", "settings"], [(e.name, e.variant, repr(e)) for e in engines], 3
    )
    console.print()
    reasons = support([Cell(one, each, 1) for one in scenes for each in engines])
    # Sorted: workers answer in any order.
    rows = sorted((cell.scene.name, method(cell.engine), why) for cell, why in reasons.items() if why)
    if rows:
        print_table(console, "Unsupported", ["scene", "method", "why"], rows, 3)
    else:
        console.print("Every engine variant builds every scene.")
