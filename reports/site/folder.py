"""Writes a site to a folder, and serves the folder by HTTP."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from reports.model.ending import BadInput, FileTrouble
from reports.run.files import folder_for, temporary_folder
from reports.site.build import MARKER
from reports.site.generator import write_files

REMEDY = "give another --output"


def refuse_strangers(output: Path) -> None:
    """Raises FileTrouble if the folder contains files that are not a site."""
    if output.is_symlink() or (output.exists() and not output.is_dir()):
        raise FileTrouble(f"{output} is no folder: {REMEDY}")
    if output.is_dir() and any(output.iterdir()) and not (output / MARKER).is_file():
        raise FileTrouble(f"{output} has files that no site wrote: {REMEDY}")


def write_site(output: Path, files: Mapping[str, bytes]) -> int:
    """Write all files to `output` and return their compressed size [bytes]. An earlier site is replaced.

    Raises FileTrouble if writing fails; an earlier site is then unchanged.
    """
    refuse_strangers(output)
    parent = folder_for(output.absolute().parent, REMEDY)
    try:
        with temporary_folder(parent) as aside:
            new = aside / "new"
            write_files(new, files)
            if output.exists():
                output.replace(aside / "old")
            new.replace(output)
    except OSError as reason:
        raise FileTrouble(f"{output} can't be written ({reason.strerror or reason}): {REMEDY}") from None
    return compressed_size(files)


def compressed_size(files: Mapping[str, bytes]) -> int:
    return sum(len(gzip.compress(content, 9, mtime=0)) for content in files.values())


class Quiet(SimpleHTTPRequestHandler):
    """A request handler without a log. The content types do not depend on the system."""

    extensions_map = {  # noqa: RUF012 (the base class has a mutable attribute too)
        **SimpleHTTPRequestHandler.extensions_map,
        ".js": "text/javascript",
        ".wasm": "application/wasm",
        ".svg": "image/svg+xml",
        ".html": "text/html; charset=utf-8",
        ".md": "text/plain; charset=utf-8",
    }

    def send_head(self) -> Any:
        """Answer 404 also to an invalid file name, for example with a zero byte."""
        try:
            return super().send_head()
        except (ValueError, OSError):
            self.send_error(404, "There is no such file")
            return None

    def handle(self) -> None:
        """A browser that leaves a page closes its connections: no error."""
        with suppress(ConnectionError):
            super().handle()

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing."""


def server(folder: Path, port: int, handler: type[Quiet] = Quiet) -> ThreadingHTTPServer:
    """A server that only this machine can reach. Port 0 selects a free port. Raises BadInput if the port is in use."""
    try:
        return ThreadingHTTPServer(("127.0.0.1", port), partial(handler, directory=str(folder)))
    except OSError as reason:
        raise BadInput(f"port {port} is not available ({reason.strerror or reason}): give another --port") from None


def serve_folder(folder: Path, port: int) -> None:
    with server(folder, port) as running:
        running.serve_forever()
