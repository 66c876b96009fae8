"""The lesson on the errata of the chapter. The page computes the numbers of its tables in assets/errata.js."""

from __future__ import annotations

from reports.site.lesson import BOTH, CENTRE, FORCES, Experiment, Lesson
from reports.site.lessons.linkages import CENTRODES, FOUR_BAR, PENDULUM
from reports.site.lessons.rolling import ROLLING
from reports.site.lessons.skates import SKATE

ERRATA = Lesson(
    "errata",
    "Errata, with numbers",
    "errata",
    (
        ROLLING.scene("a disc"),
        CENTRODES.scene("rolling"),
        SKATE.scene("the sleigh"),
        FOUR_BAR.scene("driven"),
        PENDULUM.scene("two links"),
    ),
    (
        Experiment("a disc", overlays=CENTRE, widget="errata", section="No. 1: rolling, velocity of the contact"),
        Experiment("rolling", overlays=CENTRE, widget="errata", section="No. 2: body curve and space curve"),
        Experiment("the sleigh", BOTH, overlays=FORCES, widget="errata", section="No. 11: skates, acceleration of G"),
        Experiment("driven", widget="errata", section="No. 19: example, four bar linkage: configuration variables"),
        Experiment("two links", BOTH, widget="errata", section="Right as printed"),
    ),
)
