"""The program, `crosscheck` or `python -m reports`: it ends with a status and a line, whatever happens.

Only what is loaded anyway is imported up here: Ctrl-C is taken care of before anything that takes time.
"""

from __future__ import annotations

import io
import os
import sys


def main(arguments: list[str] | None = None) -> None:
    """Run a command; without arguments, that of the process. Always raises SystemExit, with a status of ending.py."""
    program = arguments is None
    status = 130
    try:
        from reports.cli.interruption import ending_at_once, from_now_on_ignored

        with ending_at_once():  # commands that have something to say of Ctrl-C keep it for themselves
            if program:
                _open_streams()
            try:
                status = _ended(sys.argv[1:] if arguments is None else arguments)
            except KeyboardInterrupt as interruption:
                status = getattr(interruption, "status", status)
            if program:
                _leave_streams()
                from_now_on_ignored()
    except KeyboardInterrupt:
        pass
    sys.exit(status)


def _ended(arguments: list[str]) -> int:
    """Run a command; its exit status. What is wrong is told on stderr."""
    from contextlib import suppress

    from reports.model.ending import REFUSED, UNREAD, BadInput, Ending

    try:
        from planar_crosscheck import clash

        if told := clash():
            raise BadInput(told)
        from reports.cli.commands import invoke

        return invoke(arguments)
    except BrokenPipeError:
        return UNREAD
    except Ending as error:
        status, sentence = error.status, str(error)
    except OSError as error:
        status, sentence = REFUSED, ": ".join(filter(None, (error.filename, error.strerror or str(error))))
    except Exception as error:
        # Usage errors of the command line's own library: it would print several lines.
        told = getattr(error, "format_message", None)
        if told is None:
            raise
        status, sentence = REFUSED, told()
    with suppress(OSError):
        print(f"crosscheck: {' '.join(sentence.split())}", file=sys.stderr, flush=True)
    return status


def _open_streams() -> None:
    """Give streams that are closed the null device, lest a file that is opened take their number, and be written."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115 (it stays open)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files, and signs that the locale lacks


def _leave_streams() -> None:
    """What could not be written is dropped; Python would try again on its way out, and complain."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


if __name__ == "__main__":
    main()
