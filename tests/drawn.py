"""What a test reads from a drawing whose type says less than the drawing holds."""

from __future__ import annotations

from typing import Any

from matplotlib.legend import Legend
from matplotlib.text import Annotation, Text


def annotation(text: Text) -> Annotation:
    """A text that points at a place."""
    assert isinstance(text, Annotation)
    return text


def handles(legend: Legend) -> list[Any]:
    """A legend's pieces: lines, which have a colour, or patches, which have a face and a hatch."""
    found: list[Any] = [handle for handle in legend.legend_handles if handle is not None]
    assert len(found) == len(legend.legend_handles)
    return found
