"""Who reads a user's model, and the model read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from engines.entry_points import registered_by_key
from engines.loading import Kind
from engines.reading import Reader, Reading

MEMBERS = ("words", "reads", "read")


def readers() -> dict[str, Reader]:
    """Who reads a user's models, by the keys of the entry point group `crosscheck.readers`."""
    lacking = "it lacks words, reads or read"
    kind = Kind("reader", lambda value: "" if all(hasattr(value, name) for name in MEMBERS) else lacking)
    return registered_by_key("crosscheck.readers", kind)


def read(word: str, folder: Path, without: Sequence[str] = (), key: str = "", step: float | None = None) -> Reading:
    """A user's model by the first reader that knows its kind. Raises ValueError and Unsupported."""
    known = readers().values()
    for reader in known:
        if reader.reads(word):
            return reader.read(word, folder, without, key, step)
    raise ValueError(f"{word or repr(word)} is no model; give {' or '.join(reader.words for reader in known)}")
