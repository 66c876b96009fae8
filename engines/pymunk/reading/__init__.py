"""A user's pymunk space as a mechanism: `read`, and how a script's space is found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import ClassVar

import pymunk

from engines.consistent_start import closed_positions, with_consistent_start
from engines.pymunk.reading.joints import BODIES, CONSTRAINTS, described, moved_to
from engines.pymunk.reading.own_model import OwnPymunk, switch_off
from engines.pymunk.reading.script import made, rewritten
from engines.reading import AS_IT_IS, Note, Reading, ReadingTerms, Source, refuse_at_start
from reference.checks import InvalidMechanism

USUAL_STEP = 1 / 60  # s: pymunk's own examples'


def read(
    space: pymunk.Space,
    step: float | None = None,
    without: Sequence[str] = (),
    parts: int = 1,
    ahead: bool = False,
) -> Reading:
    """The mechanism of a space as it is now.

    `step` [s]: the user's; unless it is given, the last that the space was stepped by, or 1/60 s. `without`: elements
    to switch off first, in a copy. `parts`: the steps that one call of the space's own `step` makes. `ahead`: the
    user's lines start half a step ahead. Raises Unsupported
    for what has no ideal counterpart, in a sentence that names it.
    """
    if without:
        space = space.copy()
        for element in without:
            switch_off(space, element)
    found = described(space)
    last = float(space.current_time_step)
    x, y = space.gravity
    elements = found.bodies, found.joints, (float(x), float(y)), found.forces
    closed = closed_positions(*elements)
    if closed is not None:
        found = described(moved_to(found, closed[0]))
        elements = found.bodies, found.joints, (float(x), float(y)), found.forces
        found.notes.insert(0, closed[1])
    try:
        mechanism, jumped = with_consistent_start(*elements)
    except InvalidMechanism as reason:
        if not last:
            raise
        words = f"the space has been stepped by {last:g} s already, which opens joints; give it before its first step"
        raise InvalidMechanism(f"{reason}; {words}") from None
    own = OwnPymunk(found, mechanism, step or last or USUAL_STEP / parts, not (step or last), ahead)
    refuse_at_start(own, mechanism)
    if len({shape.body for shape in space.shapes if not shape.sensor}) > 1:
        found.notes.append(Note("contacts", "they are left out, since none is made in the judged motion"))
    notes = [*jumped, *found.notes, *(Note(element, "left out at your word, in your model too") for element in without)]
    return Reading(mechanism, own, tuple(notes))


def read_object(space: pymunk.Space, terms: ReadingTerms = AS_IT_IS) -> Reading:
    """`read`, with the terms of every engine's."""
    return read(space, terms.step, terms.without)


class Reader:
    """For `crosscheck check`: a variable of a script, or a function without arguments, that gives a space."""

    words = "a script with a pymunk space (path/to/script.py, or script.py:NAME)"
    elements: ClassVar[Mapping[str, str]] = {
        **BODIES,
        **{kind.__name__: words for kind, words in CONSTRAINTS.items()},
    }

    def reads(self, word: str) -> bool:
        file, _, _ = word.rpartition(":")
        return (file or word).lower().endswith(".py")

    def read(self, word: str, folder: Path, terms: ReadingTerms) -> Reading:
        """Raises ValueError for a script that gives no space, Unsupported for a space that is no mechanism."""
        if terms.key:
            raise ValueError(f"--key is {terms.key!r}; a space has no stored states")
        file, _, name = word.rpartition(":")
        file, name = (file, name) if file else (word, "")
        if name and not name.isidentifier():
            raise ValueError(f"{word}: give the name of the space in it, as in {file}:space")
        path = (folder / file).resolve()
        if path.is_dir():
            raise ValueError(f"{file}: it is a folder")
        if not path.is_file():
            raise ValueError(f"{file}: there is no such file")
        found = made(path, file, name)
        own = terms.step or (found.dt and found.dt * found.parts)
        try:
            reading = read(found.space, own and own / found.parts, terms.without, found.parts, found.ahead)
        finally:
            for body in found.space.bodies:
                if body.is_sleeping:
                    body.activate()  # pymunk (7.3.1) ends the process where a space with a sleeping body is freed
        notes = [*reading.notes]
        if found.dt is not None:
            words = f"it steps its space by {own:.4g} s; it was stopped before the first step, which is the start"
            notes.append(Note("the script", words))
        if found.ahead:
            notes.append(Note("its first step", "it brings velocities half a step ahead, as your runs here begin too"))
        if found.parts > 1:
            notes.append(Note("space.step", f"each call makes {found.parts} steps, as the script says"))
        source = Source(
            path,
            partial(rewritten, path, found, reading.model.dt),
            lambda other: self.read(f"{other.name}:{name}" if name else other.name, other.parent, terms),
        )
        return replace(reading, notes=tuple(notes), source=source)


READER = Reader()
