"""A site written whole into its folder: what was there before is replaced only by a site that is complete."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from pathlib import Path

from reports.model.ending import FileTrouble
from reports.run.files import folder_for, temporary_folder
from reports.site.build import MARKER

REMEDY = "give another --output"


def refuse_strangers(output: Path) -> None:
    """Raises FileTrouble where the folder has files and no mark of an earlier site: they would be lost."""
    if output.is_symlink() or (output.exists() and not output.is_dir()):
        raise FileTrouble(f"{output} is no folder: {REMEDY}")
    if output.is_dir() and any(output.iterdir()) and not (output / MARKER).is_file():
        raise FileTrouble(f"{output} has files that no site wrote: {REMEDY}")


def write_site(output: Path, files: Mapping[str, bytes]) -> int:
    """Write all files into `output`, an earlier site replaced; their size when compressed [bytes].

    Raises FileTrouble, and leaves the earlier site as it was.
    """
    refuse_strangers(output)
    parent = folder_for(output.absolute().parent, REMEDY)
    try:
        with temporary_folder(parent) as aside:
            new = aside / "new"
            for name, content in files.items():
                path = new / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            if output.exists():
                output.replace(aside / "old")
            new.replace(output)
    except OSError as reason:
        raise FileTrouble(f"{output} can't be written ({reason.strerror or reason}): {REMEDY}") from None
    return compressed_size(files)


def compressed_size(files: Mapping[str, bytes]) -> int:
    """What a server that compresses sends for all files [bytes], each by itself."""
    return sum(len(gzip.compress(content, 9, mtime=0)) for content in files.values())
