"""The reader of users' pymunk spaces: `read` for a space, `READER` for a script that makes one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import ClassVar

import pymunk

from engines.consistent_start import closed_positions, with_consistent_start
from engines.pymunk.reading.constraints import READ_BODIES, READ_CONSTRAINTS, copy_space, import_space, set_poses
from engines.pymunk.reading.own_model import OwnPymunk, switch_off
from engines.pymunk.reading.script import rewritten, run_script
from engines.reading import AS_IT_IS, Note, Reading, ReadingTerms, Source, refuse_at_start
from reference.checks import InvalidMechanism

ASSUMED_STEP = 1 / 60  # step of pymunk's examples [s]


def read(
    space: pymunk.Space, step: float | None = None, without: Sequence[str] = (), parts: int = 1, ahead: bool = False
) -> Reading:
    """The mechanism of a space in its current state. Raises Unsupported for an element without an ideal counterpart.

    `step` [s]: the user's step, by default the last step of the space, or else ASSUMED_STEP. `without`: kinds of
    elements to switch off in a copy. `parts`: number of steps in a call of `space.step`. `ahead`: whether the user's
    script advances the velocities by half a step at the start.
    """
    if without:
        space = space.copy()
        for element in without:
            switch_off(space, element)
    imported = import_space(space)
    last_step = float(space.current_time_step)
    gravity = float(space.gravity.x), float(space.gravity.y)
    closed = closed_positions(imported.bodies, imported.joints, gravity, imported.forces)
    if closed is not None:
        pose, note = closed
        closed_space, bodies = copy_space(imported)
        set_poses(bodies, pose)
        imported = import_space(closed_space)
        imported.notes.insert(0, note)
    try:
        mechanism, start_notes = with_consistent_start(imported.bodies, imported.joints, gravity, imported.forces)
    except InvalidMechanism as reason:
        if not last_step:
            raise
        cause = f"the space has been stepped by {last_step:g} s already, which opens joints"
        raise InvalidMechanism(f"{reason}; {cause}; give it before its first step") from None
    dt = step or last_step or ASSUMED_STEP / parts
    model = OwnPymunk(imported, mechanism, dt, step_is_assumed=not (step or last_step), ahead=ahead)
    refuse_at_start(model, mechanism)
    notes = [*start_notes, *imported.notes]
    if len({shape.body for shape in space.shapes if not shape.sensor}) > 1:
        notes.append(Note("contacts", "they are left out, since none is made in the judged motion"))
    notes += [Note(element, "switched off as you requested, in your model too") for element in without]
    return Reading(mechanism, model, tuple(notes))


def read_object(space: pymunk.Space, terms: ReadingTerms = AS_IT_IS) -> Reading:
    return read(space, terms.step, terms.without)


class SpaceReader:
    words = "a script with a pymunk space (path/to/script.py, or script.py:NAME)"
    elements: ClassVar[Mapping[str, str]] = {
        **READ_BODIES,
        **{kind.__name__: entry.read_as for kind, entry in READ_CONSTRAINTS.items()},
    }

    def reads(self, word: str) -> bool:
        file, _, _ = word.rpartition(":")
        return (file or word).lower().endswith(".py")

    def read(self, word: str, folder: Path, terms: ReadingTerms) -> Reading:
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
        script = run_script(path, file, name)
        step = terms.step or (script.dt and script.dt * script.parts)
        try:
            reading = read(script.space, step and step / script.parts, terms.without, script.parts, script.ahead)
        finally:
            for body in script.space.bodies:
                if body.is_sleeping:
                    body.activate()  # pymunk (7.3.1) aborts the process when a space with a sleeping body is freed
        notes = [*reading.notes]
        if script.dt is not None:
            stopped = f"it steps its space by {step:.4g} s; it was stopped before the first step, which is the start"
            notes.append(Note("the script", stopped))
        if script.ahead:
            notes.append(
                Note(
                    "its first step",
                    "it advances the velocities by half a step, and your runs here start in the same way",
                )
            )
        if script.parts > 1:
            notes.append(Note("space.step", f"each call makes {script.parts} steps, as the script says"))
        source = Source(
            path,
            partial(rewritten, path, script, reading.model.dt),
            lambda other: self.read(f"{other.name}:{name}" if name else other.name, other.parent, terms),
        )
        return replace(reading, notes=tuple(notes), source=source)


READER = SpaceReader()
