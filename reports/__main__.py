"""The program `crosscheck`, also `python -m reports`. After an error the program prints one line and returns an exit
status.

Slow modules are imported only after the handler of Ctrl-C is set.
"""

from __future__ import annotations

import os
import sys


def main(arguments: list[str] | None = None) -> None:
    """Run a command and raise SystemExit with its exit status. The default is the command line of the process."""
    program = arguments is None
    status = 130
    try:
        from reports.cli.interruption import ending_at_once, from_now_on_ignored
        from reports.cli.streams import leave_streams, open_streams

        with ending_at_once():  # A command may set another handler of Ctrl-C.
            if program:
                open_streams()
            try:
                status = _ended(sys.argv[1:] if arguments is None else arguments)
            except KeyboardInterrupt as interruption:
                status = getattr(interruption, "status", status)
            if program:
                leave_streams()
                from_now_on_ignored()
    except KeyboardInterrupt:
        pass
    sys.exit(status)


def _ended(arguments: list[str]) -> int:
    """Run a command and return its exit status; print errors on stderr."""
    from contextlib import suppress

    from reports.model.ending import REFUSED, UNREAD, BadInput, Ending, visible

    try:
        from planar_crosscheck import clash

        if trouble := clash():
            raise BadInput(trouble)
        from reports.cli.commands import invoke

        return invoke(arguments)
    except BrokenPipeError:
        return UNREAD
    except Ending as error:
        status, sentence = error.status, str(error)
    except OSError as error:
        status, sentence = REFUSED, ": ".join(filter(None, (error.filename, error.strerror or str(error))))
        if isinstance(error, FileNotFoundError) and error.filename is None:  # raised by os.getcwd
            sentence = "the current folder was removed; go to one that is there"
    except Exception as error:
        # typer would print its usage errors on several lines.
        message = getattr(error, "format_message", None)
        if message is None:
            raise
        status, sentence = REFUSED, message()
    with suppress(OSError):
        print(f"crosscheck: {visible(' '.join(sentence.split()))}", file=sys.stderr, flush=True)
    return status


if __name__ == "__main__":
    if not sys.flags.safe_path:  # `python -m` puts the current folder first.
        sys.path[0] = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
    main()
