"""A folder over plain HTTP on this machine, for a look at the site."""

from __future__ import annotations

from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from reports.model.ending import BadInput


class Quiet(SimpleHTTPRequestHandler):
    """Serves files and says nothing; JavaScript and WebAssembly have their types whatever the machine's table says."""

    extensions_map = {  # noqa: RUF012 (as the class above has it)
        **SimpleHTTPRequestHandler.extensions_map,
        ".js": "text/javascript",
        ".mjs": "text/javascript",
        ".wasm": "application/wasm",
        ".svg": "image/svg+xml",
        ".html": "text/html; charset=utf-8",
        ".md": "text/plain; charset=utf-8",
    }

    def send_head(self) -> Any:
        """As the class above, with an answer to a name that no file can have, such as one with a zero byte."""
        try:
            return super().send_head()
        except (ValueError, OSError):
            self.send_error(404, "There is no such file")
            return None

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing."""


def server(folder: Path, port: int) -> ThreadingHTTPServer:
    """A server of the folder for this machine alone; port 0 takes any. Raises BadInput if the port is taken."""
    try:
        return ThreadingHTTPServer(("127.0.0.1", port), partial(Quiet, directory=str(folder)))
    except OSError as reason:
        raise BadInput(f"port {port} can't be had ({reason.strerror or reason}): give another --port") from None


def serve_folder(folder: Path, port: int) -> None:
    """Serve until Ctrl-C."""
    with server(folder, port) as running:
        running.serve_forever()
