"""Where methods fail on the slider-crank: a groove off the centre of mass, dead centres, slots almost out of reach."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engines import pymunk
from engines.lagrange import Lagrange
from engines.mujoco.methods import SLOTS
from reference.checks import InvalidMechanism
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, RodEndInSlot, SliderAtDeadCentre
from reference.scenes.slider_crank.slotted_lever import SlottedLever
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Task, Values
from reports.pages.common import ALL, cells
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

FAR = 1.0  # rad
INSTANTS = 3001  # so that the time is known to a millisecond


@dataclass(frozen=True)
class Leaving(Task):
    """A slider that starts a crank, `angle` [rad] beside its dead centre."""

    angle: float

    @property
    def cost(self) -> float:
        return 0.4  # measured

    @property
    def label(self) -> str:
        return f"leaving a dead centre from {self.angle:g} rad"

    def run(self) -> Values:
        """`when`: the first of INSTANTS over the scene's duration at which the crank is further than FAR [s]."""
        scene = SliderAtDeadCentre(angle=self.angle)
        t = [scene.duration * i / (INSTANTS - 1) for i in range(INSTANTS)]
        far = scene.motion(t).pose[:, 0, 2] > FAR
        return {"when": np.asarray(t[int(np.argmax(far))] if far.any() else np.nan)}


GROOVE = (
    replace(pymunk.DEFAULT, variant="default, GrooveJoint at the rod's end", slot="groove"),
    replace(pymunk.TUNED, variant="tuned, GrooveJoint at the rod's end", slot="groove"),
)
GROOVES = cells(RodEndInSlot(), GROOVE, (1, 10, 100))
LEVER = (
    replace(pymunk.DEFAULT, variant="default, GrooveJoint in the lever", slot="groove"),
    replace(pymunk.TUNED, variant="tuned, GrooveJoint in the lever", slot="groove"),
)
LEVERS = cells(SlottedLever(), LEVER, (1, 10, 100))

LEAVING = tuple(map(Leaving, (1e-2, 1e-4, 1e-6)))


def delay(material: Material) -> dict[str, Any]:
    """`later` [s]: how much later the nearest start leaves than one a hundred times as far aside; `nearer`: log 100."""
    far, near = (material.finished(task) for task in LEAVING[-2:])
    later = near.number("when") - far.number("when") if far and near else UNMEASURED
    return {"later": later, "nearer": math.log(LEAVING[-2].angle / LEAVING[-1].angle)}


def leaving(material: Material) -> list[Observation]:
    """When the truth has left the dead centre by a radian, for starts nearer and nearer to it."""
    found = []
    for task in LEAVING:
        if (answer := material.answers.get(task)) is not None:
            told = f"a radian away after {answer.number('when'):.3f} s" if answer.finished else answer.told
            found.append(Observation("the reference", f"{number(task.angle)} rad aside", told))
    return found


def refusals(material: Material) -> list[Observation]:
    """What the reference says to slots that can't be reached."""
    found = []
    shape = DrivenSliderCrank()
    for offset in (shape.rod - shape.crank, 1.0):
        try:
            replace(shape, offset=offset)
        except InvalidMechanism as sentence:
            found.append(Observation("the reference", f"offset {offset:.3g} m", f"refuses: {sentence}"))
    return found


FAILURES: tuple[Failure, ...] = (
    Failure(
        title="The rod's end in a groove",
        expected=(
            "Without a sliding block the rod's own end runs in the slot. Crank and rod move as before: the crank is "
            "driven, and mass does not enter."
        ),
        cells=GROOVES + cells(RodEndInSlot(), ALL, (1, 10, 100)),
        remark=(
            "Use a `GrooveJoint` only where turning moves neither the groove nor the anchor. The groove is then in the "
            "ground or in a body that can't turn, and the anchor at a centre of mass or on such a body. Right too are "
            "arms, from a centre of mass to the anchor, that lie along or across the groove. The joint solves for "
            "the impulse that would stop its anchor in both directions, and then keeps the part along the "
            "normal ([cpGrooveJoint.c, line 76]"
            "(https://github.com/viblo/Munk2D/blob/2.0.1/src/cpGrooveJoint.c#L76)). This is the right impulse only if "
            "the normal is an eigenvector of the inverse mass at the anchor, as in the cases named. "
            "At a rod's end the joint settles at a wrong impulse, so the error as shipped is the same at every step. "
            "Only the gap shows it. If all of the gap is closed, the error falls with the step, at order 1. In the "
            "other methods a pin joint from far away across the slot holds it (pymunk), or a row or a slide (MuJoCo). "
            "They have no such error."
        ),
    ),
    Failure(
        title="A groove in a moving lever",
        expected=(
            "The slot turns: a pin on the driven crank slides in a lever that swings about a pivot of its own. The "
            "slot passes the lever's centre of mass at a distance. The lever follows the pin exactly; mass does not "
            "enter."
        ),
        cells=LEVERS + cells(SlottedLever(), (*ALL, *SLOTS), (1, 10, 100)),
        remark=(
            "The same joint with the same fault, here by the arm from the lever's centre of mass to the pin. As "
            "shipped pymunk lets the slot open at every step"
            "{% filter if_measured %}, by {{ at('pymunk default, GrooveJoint in the lever', 1e-4).gap | number }} m "
            "at the smallest one{% endfilter %}. With all of the gap closed in each step it holds, at order 1 instead "
            "of 2. The other rows of pymunk hold the slot by a pin joint from far away, which is right. What the joint "
            "computes, and in which cases it is right: [faults of released engines]"
            "(faults.md#pymunk-groovejoint-drives-the-wrong-velocity-to-zero). MuJoCo has slides for slots of a tree, "
            "and nothing for one that closes a loop. By its own parts alone half of the crank slides and turns in the "
            "lever, and is welded to the other half. In the row 'tuned, slots as rows' the slot is an equation of ours"
            "{% filter if_measured %}: {{ at('mujoco tuned, slots as rows', 1e-4).solver_rows }} row of the solver "
            "instead of {{ at('mujoco tuned', 1e-4).solver_rows }}, and "
            "{{ at('mujoco tuned, slots as rows', 1e-4).angle | number }} rad instead of "
            "{{ at('mujoco tuned', 1e-4).angle | number }} at the smallest step{% endfilter %}."
        ),
    ),
    Failure(
        title="A slider that has to start the crank, next to its dead centre",
        expected=(
            "Everything is pushed along the slot, from rest, a millionth of a radian beside the outer dead centre. The "
            "slider has almost no lever, but the motion is exact: the crank leaves, always to the side where it stood."
        ),
        cells=cells(SliderAtDeadCentre(), (*ALL, Lagrange("rk4", "projection")), (1, 10)),
        tasks=LEAVING,
        words=delay,
        observations=leaving,
        remark=(
            "A start a hundred times nearer leaves {% filter if_measured %}{{ later | number }} s {% endfilter "
            "%}later: errors grow{% filter if_measured %} by e every {{ (later / nearer) | number }} s{% endfilter "
            "%}, as the motion does. So an error counts relative to how far aside the slider is. In these methods an "
            "open joint does not push to the side, so none goes the wrong way. They differ only in the time."
        ),
    ),
    Failure(
        title="A slider in its dead centre",
        expected="Exactly in line it has no lever at all, and stays for ever, in an equilibrium that can't be kept.",
        cells=cells(SliderAtDeadCentre(angle=0.0), ALL, (1, 10)),
        remark=(
            "Symmetry keeps it there: all forces lie along one line, and so does all rounding. If the crank never "
            "starts in a simulation, a real machine may start all the same."
        ),
    ),
    Failure(
        title="A slot out of reach",
        expected="With an offset of rod minus crank or more the crank can't turn fully.",
        observations=refusals,
        remark="No engine is asked: there is no motion that it could be held against.",
    ),
)
