"""Where methods fail on a person: standing itself, a light shank under a heavy trunk, knees almost straight."""

from __future__ import annotations

import math
from dataclasses import replace

from engines import pymunk
from reference.checks import InvalidMechanism
from reference.scenes.person import OneFoot, SwayingOnOneFoot, TwoFeet, modes_upright
from reports.model.page import Failure, Material, Observation
from reports.pages.common import ALL, cells, sweeps

LONGER = SwayingOnOneFoot(duration=0.6, horizon=0.6)


def growth(material: Material) -> list[Observation]:
    """The modes of standing upright on one foot."""
    squares, _ = modes_upright(SwayingOnOneFoot())
    found = []
    for square in squares:
        rate = math.sqrt(abs(square))
        said = f"swings at {rate:.3g} rad/s" if square < 0 else f"grows by e in {1 / rate:.3g} s"
        found.append(Observation("the reference, linearised", "upright on one foot", said))
    return found


def refusals(material: Material) -> list[Observation]:
    """What the reference says to stances that can't be."""
    found = []
    for wrong in ({"stance": 2.0}, {"hip_y": 0.95}, {"knees": 0}, {"height": 0.0}):
        try:
            replace(TwoFeet(), **wrong)
        except InvalidMechanism as sentence:
            setting = ", ".join(f"{name} = {value!r}" for name, value in wrong.items())
            found.append(Observation("the reference", setting, f"refuses: {sentence}"))
    return found


FAILURES: tuple[Failure, ...] = (
    Failure(
        title="Standing still",
        expected=(
            "Upright on one foot is an equilibrium with five modes, two that swing and three that grow. The sway "
            f"starts on one that swings, to six digits; after {SwayingOnOneFoot().duration:g} s what the digits left "
            "out has grown, and the knee buckles."
        ),
        cells=cells(LONGER, ALL, (1, 10, 100)),
        observations=growth,
        remark=(
            "The knee's mode makes a millionth of a radian a visible angle within half a second. Without muscles "
            "nobody sways for longer than that. If a simulated body without muscles stands, then because of the "
            "simulation's softness, friction or rounding. The errors grow with the same mode{% filter if_measured %}: "
            "pymunk as shipped, of first order, is off by "
            '{{ at("pymunk default", 1e-2).angle | number }} rad at 10 ms, by '
            '{{ at("pymunk default", 1e-3).angle | number }} rad at 1 ms and by '
            '{{ at("pymunk default", 1e-4).angle | number }} rad at 0.1 ms{% endfilter %}.'
        ),
    ),
    Failure(
        title="A heavy trunk on light shanks, with too few sweeps",
        expected="A shank has a fifteenth of the trunk's mass and is two joints away from it.",
        cells=cells(OneFoot(), (pymunk.DEFAULT,), (1, 10))
        + cells(OneFoot(), map(sweeps, (5, 10, 20, 100)), (1, 3, 10, 30, 100)),
        remark=(
            "How many sweeps a chain needs depends on its masses as well as on its length. For a few equal links five "
            "sweeps would be enough. Here ten are too few, and with five or ten the smaller step is the worse one. "
            "What they leave is corrected at a speed of the gap over the step."
        ),
    ),
    Failure(
        title="Stances that can't be",
        expected="Feet too far apart, a hip out of reach, a person without a height.",
        observations=refusals,
        remark="Nothing is built: an engine would start with a torn leg and close the gap at once.",
    ),
)
