"""A user's pymunk space as a mechanism: `read`, and how a script's space is found."""

from __future__ import annotations

import contextlib
import io
import runpy
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pymunk

from engines.pymunk.reading.joints import described
from engines.pymunk.reading.own_model import OwnPymunk, switch_off
from engines.reading import Note, Reading, refuse_at_start
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism

USUAL_STEP = 1 / 60  # s: pymunk's own examples'


def read(space: pymunk.Space, step: float | None = None, without: Sequence[str] = ()) -> Reading:
    """The mechanism of a space as it is now.

    `step` [s]: the user's; unless it is given, the last that the space was stepped by, or 1/60 s. `without`: elements
    to switch off first, in a copy. Raises Unsupported for what has no ideal counterpart, in a sentence that names it.
    """
    if without:
        space = space.copy()
        for element in without:
            switch_off(space, element)
    found = described(space)
    last = float(space.current_time_step)
    x, y = space.gravity
    try:
        mechanism = Mechanism(tuple(found.bodies), tuple(found.joints), (float(x), float(y)), tuple(found.forces))
    except InvalidMechanism as reason:
        if not last:
            raise
        words = f"the space has been stepped by {last:g} s already, which opens joints; give it before its first step"
        raise InvalidMechanism(f"{reason}; {words}") from None
    own = OwnPymunk(found, mechanism, step or last or USUAL_STEP, not (step or last))
    refuse_at_start(own, mechanism)
    if len({shape.body for shape in space.shapes if not shape.sensor}) > 1:
        found.notes.append(Note("contacts", "they are left out, since none is made in the judged motion"))
    notes = [*found.notes, *(Note(element, "left out at your word, in your model too") for element in without)]
    return Reading(mechanism, own, tuple(notes))


class Reader:
    """For `crosscheck check`: a variable of a script, or a function without arguments, that gives a space."""

    words = "a script with a pymunk space (path/to/script.py:NAME)"

    def reads(self, word: str) -> bool:
        file, _, _ = word.rpartition(":")
        return (file or word).lower().endswith(".py")

    def read(self, word: str, folder: Path, without: Sequence[str], key: str, step: float | None) -> Reading:
        """Raises ValueError for a script that gives no space, Unsupported for a space that is no mechanism."""
        if key:
            raise ValueError(f"--key is {key!r}; a space has no stored states")
        file, _, name = word.rpartition(":")
        if not file or not name.isidentifier():
            raise ValueError(f"{word}: give the name of the space in it too, as in script.py:space")
        path = (folder / file).resolve()
        if path.is_dir():
            raise ValueError(f"{file}: it is a folder")
        if not path.is_file():
            raise ValueError(f"{file}: there is no such file")
        value = _run(path, file, name)
        if not isinstance(value, pymunk.Space):
            raise ValueError(f"{word}: it is {type(value).__name__}; it must be a pymunk.Space, or give one")
        try:
            return read(value, step, without)
        finally:
            for body in value.bodies:
                if body.is_sleeping:
                    body.activate()  # pymunk (7.3.1) ends the process where a space with a sleeping body is freed


def _run(path: Path, file: str, name: str) -> Any:
    """What a script's name stands for, called if it can be. What the script prints is dropped."""
    sys.path.insert(0, str(path.parent))
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            values = runpy.run_path(str(path), run_name="crosscheck_check")
            if name not in values:
                raise ValueError(f"{file}: it has no {name!r}")
            value = values[name]
            return value() if callable(value) else value
    except (Exception, SystemExit, KeyboardInterrupt) as reason:
        if isinstance(reason, ValueError) and str(reason).startswith(f"{file}: it has no"):
            raise
        words = " ".join(str(reason).split())
        raise ValueError(f"{file} raised {type(reason).__name__}{f': {words}' if words else ''}") from None
    finally:
        sys.path.remove(str(path.parent))


READER = Reader()
