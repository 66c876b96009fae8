"""Advised settings written into a copy of the user's model, which is run: what it reached is told, not promised."""

from __future__ import annotations

from pathlib import Path

from engines import Unsupported
from reports.check.checked import Applied, Checked
from reports.run.files import is_stream

MUCH_MORE = 1.1  # times what was promised: then not all settings have reached the model


def applied(found: Checked, target: Path) -> Applied:
    """Write the advised settings, or the model as it is where it is within the tolerance already.

    Raises Unsupported where nothing can be written; then the target is as it was.
    """
    source, advised = found.reading.source, found.advised
    if source is None:
        raise Unsupported("--apply: this model has no text to be changed; give its MJCF file or its script")
    if is_stream(target):
        raise Unsupported(f"--apply: {target} is no file, and the model is read from it again")
    if target.suffix.lower() != source.path.suffix.lower():
        raise Unsupported(f"--apply is {str(target)!r}; it must end in {source.path.suffix}, as the model does")
    if advised is None:
        raise Unsupported(
            f"--apply: no documented setting that was tried meets {found.tolerance:g}, so nothing was written; give "
            "--fix-to for a longer search, or a larger tolerance"
        )
    own = found.table[0]
    change, words = (own.change, "your settings as they are") if found.met else (advised.change, advised.change.words)
    text = source.path.read_bytes() if found.met else source.changed(change)
    try:
        # Beside the target, where the files that the model names are looked for.
        aside = target.with_name(f".{target.stem}.crosscheck{target.suffix}")
        aside.write_bytes(text)
        try:
            reading = source.read(aside)
            error, cpu = found.rerun(reading)
            aside.replace(target)
        finally:
            aside.unlink(missing_ok=True)
    except OSError as reason:
        raise Unsupported(f"--apply: {target} can't be written ({reason.strerror or reason})") from None
    notes = [f"{note.element}: {note.reason}" for note in reading.notes if note not in found.reading.notes]
    promised = own.error if found.met else advised.error
    if not error <= MUCH_MORE * promised + 1e-12:
        notes.append(
            f"{promised:.2g} was expected: some elements keep values of their own, such as those of an included file"
        )
    return Applied(str(target), words, error, cpu, tuple(notes))
