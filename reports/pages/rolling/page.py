"""The page of rolling: bodies that are not round, by contact and by constraint, and two elliptic gears."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines import Engine
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from engines.registry import VARIANTS
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Line
from reference.rolling.kinematics import Rolling
from reference.scene import Scene
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import (
    RollingCam,
    RollingDisc,
    RollingDownhill,
    RollingEllipse,
    RollingInRing,
    RollingOnCircle,
    RollingScene,
)
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.pages.common import deviations
from reports.pages.rolling import drawings as rolling_drawings
from reports.pages.rolling.experiments import FAILURES, polygon_cells
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg
from reports.write.rows import Rows, lookups
from reports.write.unmeasured import Known

COEFFICIENTS = (0.2, 0.5, 1.0)


def draw_acceleration(theme: Theme = LIGHT) -> Figure:
    """The rolling term beside that of a body pinned at C: over an ellipse's turn, and against how well curves fit."""
    with settings():
        figure = new_figure(3.6, theme)
        left, right = figure.subplots(1, 2)
        rolling = Rolling.at_angle(Ellipse(0.5, 0.3), Line())
        theta = np.linspace(0, math.pi, 400)
        pinned = np.linalg.norm(rolling.pinned_acceleration(theta, 1.0, 0.0), axis=-1)
        term = np.linalg.norm(rolling.rolling_acceleration(theta, 1.0), axis=-1)
        for values, name, colour, place in (
            (pinned, "pinned at C: $\\omega^2 r$", theme.second, 200),
            (term, "rolling: $\\omega^2/(\\kappa_A+\\kappa_B)$", theme.first, 30),
        ):
            left.plot(np.degrees(theta), values, color=colour, linewidth=2)
            left.annotate(name, (np.degrees(theta[place]), values[place]), xytext=(4, 6), textcoords="offset points",
                          color=colour)  # fmt: skip
        _axes(
            left,
            theme,
            "an ellipse on flat ground, its centre",
            "rotation [degrees]",
            "acceleration at 1 rad/s [m/s$^2$]",
        )
        left.set_xticks([0, 45, 90, 135, 180])
        fit = np.geomspace(1e-3, 30, 200)  # (kappa_A + kappa_B) / kappa_B of a disc
        right.plot(fit, 1 / fit, color=theme.first, linewidth=2)
        right.axhline(1.0, color=theme.second, linewidth=2)
        right.annotate("as if pinned at C", (1.3e-2, 1.0), xytext=(0, -12), textcoords="offset points",
                       color=theme.second)  # fmt: skip
        right.annotate("what rolling adds", (2e-3, 500), xytext=(12, 2), textcoords="offset points",
                       color=theme.first)  # fmt: skip
        for place, word in ((1.0, "flat"), (10.0, "sharp"), (0.01, "hole 1 %\nlarger")):
            right.axvline(place, color=theme.quiet, linewidth=0.8, linestyle=":")
            right.annotate(
                word,
                (place, 0.025 if place < 5 else 4.0),
                xytext=(3, 0),
                textcoords="offset points",
                color=theme.quiet,
                va="bottom",
            )
        right.set_xscale("log")
        right.set_yscale("log")
        right.set_ylim(0.02, 2e3)
        _axes(right, theme, "a disc's centre, against how well the curves fit", "$(\\kappa_A+\\kappa_B)/\\kappa_B$",
              "parts of $\\omega^2 r$")  # fmt: skip
    return figure


def draw_friction(scenes: Sequence[RollingScene], theme: Theme = LIGHT) -> Figure:
    """|T|/N over time, the coefficients that would do, and the instants at which a real contact slips or hops."""
    with settings():
        figure = new_figure(3.6, theme)
        for index, (panel, scene) in enumerate(zip(figure.subplots(1, len(scenes), sharey=True), scenes, strict=True)):
            law, end = scene.motion_law, scene.hop or scene.duration
            t = np.linspace(0, end * (1 - 1e-9), 800)
            panel.plot(t, law.required_friction(t), color=theme.ink, linewidth=1.8)
            for friction in COEFFICIENTS:
                slip = law.slip(friction, scene.duration)
                panel.axhline(friction, color=theme.second, linewidth=1.0, linestyle="--")
                # Beside the panel: within it, the curve crosses these lines anywhere.
                panel.annotate(f"$\\mu$ = {friction:g}", (1.0, friction), xycoords=("axes fraction", "data"),
                               xytext=(3, 0), textcoords="offset points", color=theme.second, fontsize=8,
                               va="center", annotation_clip=False)  # fmt: skip
                if slip is not None:
                    panel.plot(slip, friction, "o", color=theme.first, markersize=6, zorder=4)
                    early = slip < 0.3 * scene.duration
                    panel.annotate(f"slips {slip:.3f} s", (slip, friction), xytext=(7, -11) if early else (-7, 4),
                                   textcoords="offset points", color=theme.first, fontsize=8,
                                   ha="left" if early else "right")  # fmt: skip
            if scene.hop is not None:
                panel.axvline(scene.hop, color=theme.first, linewidth=1.4)
                panel.annotate(f"hops {scene.hop:.3f} s", (scene.hop, 1.45), xytext=(-14, 0),
                               textcoords="offset points", color=theme.first, fontsize=8, ha="right")  # fmt: skip
            panel.set_ylim(0, 1.6)
            panel.set_xlim(0, scene.duration)
            title = scene.name.replace("_", " ")
            _axes(panel, theme, title, "time [s]", "friction demanded, |T| / N" if index == 0 else "")
    return figure


def _axes(panel: Axes, theme: Theme, title: str, across: str, up: str) -> None:
    style_axes(panel, theme)
    panel.set_title(title, loc="left", fontsize=9.5, color=theme.ink)
    panel.set_xlabel(across)
    panel.set_ylabel(up)


SCENES = (
    RollingEllipse(),
    RollingDisc(),
    RollingCam(),
    RollingDownhill(),
    RollingInRing(),
    RollingOnCircle(),
    EllipticGears(),
)
# Ideal constraints under Euler say nothing here that Runge-Kutta's don't, and finding a contact is what costs.
COMPARED = tuple(engine for engine in VARIANTS if engine.variant != "euler projection")
CONSTRUCTIONS: tuple[Engine, ...] = (pymunk_methods.ROLL_PIVOT, *mujoco_methods.ROLLS)

HILL = RollingOnCircle()  # kept: it works out once until when it can be compared


def compared(scene: Scene, engine: Engine) -> bool:
    """All but exact multipliers where each contact is a search within a search: the tests hold those to the truth.
    What is compared beside the variants is compared on the ellipse alone.
    """
    if engine in CONSTRUCTIONS:
        return scene.name == RollingEllipse.name
    return not (engine.name == "lagrange" and scene.name in (EllipticGears.name, RollingInRing.name))


def figures(material: Material) -> dict[str, str]:
    """Drawings from the reference."""
    return {
        "roulettes": svg(
            rolling_drawings.draw_roulettes(rolling_drawings.roulettes()),
            "Six bodies that roll, and what a point draws",
        ),
        "contact": svg(rolling_drawings.draw_contact(), "An ellipse on a hill, on flat ground and in a hole"),
        "acceleration": svg(draw_acceleration(), "The acceleration's two parts"),
        "friction": svg(draw_friction((RollingEllipse(), RollingOnCircle())), "Friction demanded and friction given"),
        "gears": svg(rolling_drawings.draw_gears(EllipticGears()), "Two elliptic gears and their rates"),
    }


def words(material: Material) -> Mapping[str, Any]:
    """Rows and sweeps by method, for sentences; `at` takes a method in one word, and a step."""
    rows = Rows(material.sweep(SCENES))

    def at(scene: str, method: str, step: float) -> Any:
        """The row of a method ("mujoco tuned") at about a step [s]."""
        return rows.of(scene, method).near(step)

    polygons = Known(
        {(corners, cell.every): material.rows[cell] for corners, cell in polygon_cells() if cell in material.rows}
    )
    return {**lookups(material, SCENES), "at": at, "polygons": polygons, "hill": HILL}


# Where a method is known to fall short of theory in rolling.
POLYGON = "by design: a body that is not round is a polygon here, and rolls from corner to corner in blows"
SOFT = "by design: as shipped the contact is a spring of 0.02 s, whatever the step"
CHATTER = "upstream: a contact without the velocity term is let go and caught again; its force is right on average"
BARELY = "by design: pins already hold the gears apart, so that only softness lets them press and rub"


KNOWN = deviations(
    {
        POLYGON: {
            ("rolling_ellipse", "pymunk default"): Outcome.SATURATED,
            ("rolling_ellipse", "pymunk tuned"): {"error": 1.2, "reaction": 17},
            ("rolling_cam", "pymunk default"): Outcome.SATURATED,
            ("rolling_cam", "pymunk tuned"): {"error": 11, "rate": 4.8, "energy": 1.3, "reaction": 75},
            ("rolling_incline", "pymunk default"): {
                "error": 15,
                "rate": 6.3,
                "gap": 4.5,
                "energy": 5.1,
                "reaction": 480,
            },
            ("rolling_incline", "pymunk tuned"): {"error": 2.3, "rate": 1.1, "energy": 1.2, "reaction": 120},
            ("elliptic_gears", "pymunk default"): {"reaction": 9.2},
            ("elliptic_gears", "pymunk tuned"): {"reaction": 2.3},
        },
        SOFT: {
            ("rolling_ellipse", "mujoco default"): {"order": 2.5},
            ("rolling_disc", "mujoco default"): {"order": 2.5},
            ("rolling_on_circle", "mujoco default"): {"order": 2.5},
        },
        CHATTER: {
            ("rolling_ellipse", "mujoco tuned"): {"reaction": 3.8},
            ("rolling_ellipse", "mujoco contact, stiff Euler"): {"reaction": 4.9},
            ("rolling_disc", "mujoco tuned"): {"reaction": 44},
            ("rolling_incline", "mujoco default"): {"reaction": 1.6, "order": 2.5},
            ("rolling_incline", "mujoco tuned"): {"reaction": 31},
            ("rolling_on_circle", "pymunk default"): {"reaction": 16},
            ("rolling_on_circle", "pymunk tuned"): {"reaction": 16},
            ("rolling_on_circle", "mujoco default"): {"reaction": 2.8},
            ("rolling_on_circle", "mujoco tuned"): {"reaction": 61},
        },
        BARELY: {
            ("elliptic_gears", "mujoco default"): {"order": 2.5},
            ("elliptic_gears", "mujoco tuned"): {"reaction": 4},
        },
    }
)

PAGE = Page(
    name="rolling",
    title="Rolling of bodies that are not round",
    lesson="The contact runs along both curves. That motion adds to accelerations, and MuJoCo's contacts leave it out.",
    scenes=SCENES,
    engines=(*COMPARED, *CONSTRUCTIONS),
    failures=FAILURES,
    compared=compared,
    figures=figures,
    words=words,
    known=KNOWN,
)
