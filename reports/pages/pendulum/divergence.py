"""How fast neighbouring motions of the long pendulum part."""

from __future__ import annotations

from reference.scenes.pendulum.scenes import LinkPendulum
from reports.pages.page import Material, Observation
from reports.pages.pendulum.neighbours import Neighbours
from reports.text.tables import number

BEYOND = LinkPendulum(duration=12.0, horizon=12.0)


PARTING = Neighbours(BEYOND, (1.0, LinkPendulum().horizon, 6.0, 9.0, BEYOND.duration))


def divergence(material: Material) -> list[Observation]:
    """How much a difference of the start has grown, measured on neighbours of the double pendulum."""
    if (answer := material.answers.get(PARTING)) is None:
        return []
    method = "the reference, by neighbouring starts"
    if not answer.finished:
        return [Observation(method, "", answer.told)]
    return [
        Observation(method, f"{t:.3g} s", f"{number(growth)} times the difference at 0 s")
        for t, growth in zip(PARTING.times, answer.array("growth"), strict=True)
    ]
