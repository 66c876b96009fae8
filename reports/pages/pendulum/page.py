"""The pendulums' page: one link to a hundred, as a tree and with every joint a constraint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from engines import mujoco
from engines.registry import VARIANTS
from reference.scenes.pendulum.link import BarPendulum, PointPendulum
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks
from reports.model.page import FEATURED, Material, Page
from reports.pages.pendulum.expectations import KNOWN
from reports.pages.pendulum.experiments import FAILURES, SOLVED
from reports.plots.mechanisms import Strip, stroboscope
from reports.plots.theme import svg
from reports.write.rows import lookups

NAME = "pendulum"
SCENES = (BarPendulum(), LinkPendulum(), TenLinks(), HundredLinks(), PointPendulum())

# Every joint an equality on bodies that are free in the plane: what the coordinates alone are worth.
FREE = (replace(mujoco.DEFAULT, variant="default, free coordinates", coordinates="free"), SOLVED)
SHOWN = (*FEATURED, *(engine.variant for engine in FREE))


def figures(material: Material) -> dict[str, str]:
    """Stroboscopic pictures of the truth."""
    one, two, ten, hundred = BarPendulum(), LinkPendulum(), TenLinks(), HundredLinks()
    end = ((one.length / 2, 0.0),)
    strips = (
        Strip(one, "One link", 12, end=1.1, ends={"link 1": end}),
        Strip(two, "Two links, and the path of the tip", 21, end=2.0, ends={"link 2": end}, trace=("link 2", end[0])),
        Strip(ten, "Ten links", 11, end=2.0, ends={"link 10": end}),
        Strip(hundred, "A hundred links", 9, ends={"link 100": end}),
    )
    return {"stroboscope": svg(stroboscope(strips), "Pendulums of one, two, ten and a hundred links in motion")}


def words(material: Material) -> Mapping[str, Any]:
    """Rows by method, and how often the point pendulum swings to and fro."""
    point = PointPendulum()
    return {**lookups(material, SCENES), "periods": round(point.duration / point.pendulum.period)}


PAGE = Page(
    name=NAME,
    title="Pendulums of 1, 2, 10 and 100 links",
    lesson="Open chains: in a tree of coordinates the joints are exact, and pymunk finds their impulses by iteration.",
    scenes=SCENES,
    advised="pendulum_2",
    engines=(*VARIANTS, *FREE),
    failures=FAILURES,
    featured=lambda row: row.variant in SHOWN,
    figures=figures,
    words=words,
    known=KNOWN,
)
