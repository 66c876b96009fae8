"""The process that runs the cells of one version and sends the rows. The version's folder is first in sys.path.

`reports.versions.column` starts the process and writes two pickles to its standard input: folders of further modules,
and a VersionRequest. The process and its workers end when this pipe is closed. Standard output is redirected before
modules are imported that may import an engine, since an engine may print.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
from typing import Any


def main() -> None:
    """Answer one request with pickled messages on the standard output. The last message is None or a Loss."""
    # Only the parent handles signals that are sent to all processes of the command.
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    # All output of an engine goes to the standard error, also output of native code and during the import.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.path += [path for path in pickle.load(sys.stdin.buffer) if path not in sys.path]
    from reports.versions.column import answer

    request = pickle.load(sys.stdin.buffer)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()

    def send(message: Any) -> None:
        pickle.dump(message, out)
        out.flush()

    send(answer(request, send))
    os._exit(0)  # A normal exit would wait for threads of an engine.


def _end_with_the_parent() -> None:
    while os.read(sys.stdin.fileno(), 1):
        pass
    os._exit(1)


if __name__ == "__main__":
    main()
