"""A user's MJCF or URDF with other settings in it: a few attributes are set, all else stays as it is, comments too."""

from __future__ import annotations

import re
from xml.parsers import expat

from engines.mujoco.reading.settings import tied_values
from engines.reading import Change, refuse

Tag = tuple[tuple[str, ...], int, int]  # the path of an element, and where its start tag begins and ends


def rewritten(source: bytes, change: Change) -> bytes:
    """The file with these settings. What an included file says is out of reach. Raises Unsupported if it is no XML."""
    options = dict(change.options)
    option = {"timestep": f"{change.dt!r}", "integrator": options["integrator"]}
    tags = _tags(source)
    root = tags[0]
    home = root if root[0] == ("mujoco",) else next((tag for tag in tags if tag[0] == (root[0][0], "mujoco")), None)
    there = [] if home is None else [tag for tag in tags if tag[0] == (*home[0], "option")]
    edits = [(begin, end, _with(source[begin:end], option)) for _, begin, end in there]
    if not there:
        words = b"<option " + b" ".join(f'{name}="{value}"'.encode() for name, value in option.items()) + b"/>"
        if home is None:  # a URDF file without an element of MuJoCo's
            end = source.rindex(b"</")
            edits.append((end, end, b"  <mujoco>" + words + b"</mujoco>\n"))
        elif source[home[1] : home[2]].endswith(b"/>"):
            edits.append((home[1], home[2], b"<mujoco>" + words + b"</mujoco>"))
        else:
            edits.append((home[2], home[2], b"\n  " + words))
    if options["tied"]:
        values = tied_values(change.dt)
        held = (tag for tag in tags if len(tag[0]) == 3 and tag[0][:2] == ("mujoco", "equality"))
        edits += [(begin, end, _with(source[begin:end], values)) for _, begin, end in held]
    for begin, end, text in sorted(edits, reverse=True):
        source = source[:begin] + text + source[end:]
    return source


def _tags(source: bytes) -> list[Tag]:
    """Every element, in the order of the file."""
    parser, path, found = expat.ParserCreate(), list[str](), list[Tag]()

    def begins(name: str, attributes: dict[str, str]) -> None:
        path.append(name)
        begin = parser.CurrentByteIndex
        tag = re.compile(rb"<(?:[^>\"']|\"[^\"]*\"|'[^']*')*>").match(source, begin)
        assert tag is not None
        found.append((tuple(path), begin, tag.end()))

    parser.StartElementHandler = begins
    parser.EndElementHandler = lambda name: path.pop()
    try:
        parser.Parse(source, True)
    except expat.ExpatError as error:  # MuJoCo's own reader forgives more
        raise refuse("the file", f"it is not well-formed XML ({error}), so nothing can be written into it") from None
    return found


def _with(tag: bytes, values: dict[str, str]) -> bytes:
    """A start tag with these attributes."""
    for name, value in values.items():
        attribute = f'{name}="{value}"'.encode()
        tag, count = re.subn(rf"(?<=\s){name}\s*=\s*(\"[^\"]*\"|'[^']*')".encode(), attribute, tag)
        if not count:
            tag = re.sub(rb"\s*(/?>)$", lambda end, own=attribute: b" " + own + end[1], tag)
    return tag
