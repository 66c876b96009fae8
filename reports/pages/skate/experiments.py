"""Where constructions of a skate fail: experiments with a statement of what should happen."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from engines import Engine
from reference.chapter.integrability import freedoms_by_brackets, mechanism_is_integrable
from reference.joints import Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.scene import Scene
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.scenes.skates.slopes import HeldBySkates, SkateOnSlope
from reports.model.cells import Cell
from reports.model.page import Failure, Material, Observation
from reports.model.tasks import Motion
from reports.pages.skate.methods import (
    GROWING,
    LIMITED,
    ORDINARY,
    PEAK,
    TURNING_ROUND,
    backwards,
    delays,
    method,
    slipping,
)


def _body(*joints: Pin | Skate) -> Mechanism:
    return Mechanism((Body("body", 2.0, 0.3, (0.0, 0.0, 0.0)),), joints)


def _skate(name: str, point: tuple[float, float], angle: float = 0.0) -> Skate:
    return Skate(name, None, "body", point, angle)


COUNTED: tuple[tuple[str, Mechanism], ...] = (
    ("free body", _body()),
    ("pinned body (18.62)", _body(Pin("pin", None, "body", (-0.5, 0.0), (-0.5, 0.0)))),
    ("one skate (18.64)", _body(_skate("one", (-0.5, 0.0)))),
    ("two skates on one axle", _body(_skate("left", (-0.5, 0.2)), _skate("right", (-0.5, -0.2)))),
    ("two skates in one line", _body(_skate("rear", (-0.5, 0.0)), _skate("front", (0.5, 0.0)))),
    ("two skates, one steered", _body(_skate("rear", (-0.5, 0.0)), _skate("front", (0.5, 0.0), 0.4))),
    ("a pin and a skate off it", _body(Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0)), _skate("skate", (0.5, 0.0)))),
    (
        "a pin and a skate square to it",
        _body(Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0)), _skate("skate", (0.5, 0.0), np.pi / 2)),
    ),
    ("three skates", HeldBySkates().mechanism()),
)


def counting(material: Material) -> list[Observation]:
    """Freedoms by rank and by brackets, and integrability by Frobenius, of skates on one body."""
    found = []
    for name, mechanism in COUNTED:
        configuration, velocity = mechanism.degrees_of_freedom()
        reached = freedoms_by_brackets(mechanism)[-1] if velocity else 0
        kind = "integrable" if mechanism_is_integrable(mechanism) else "not integrable"
        said = f"({configuration}, {velocity}); {kind}: of {configuration} it can reach {reached}"
        if velocity == 0:
            said = f"({configuration}, {velocity}): nothing can move, wherever it stands"
        found.append(Observation(name, f"{mechanism.row_count} row{'' if mechanism.row_count == 1 else 's'}", said))
    return found


Columns = tuple[str, ...]
MOTION: Columns = ("position", "angle", "slip", "energy")


def _cells(
    scene: Scene, engines: Iterable[Engine], every: Iterable[int], samples: int | None = None
) -> tuple[Cell, ...]:
    return tuple(
        Cell(scene, engine, count, "failure", samples)
        for engine in engines
        for count in _affordable(engine, tuple(every))
    )


def _affordable(engine: Engine, every: tuple[int, ...]) -> tuple[int, ...]:
    """What runs a cell at many steps is at rounding with the longest already."""
    return every[:1] if engine.variant == "extended" else every


NAIVE = tuple(method(f"pymunk skate: {name}") for name in ("centre's velocity zeroed", "point's velocity zeroed"))
LONG = 1000.0  # s
CIRCLING = ChaplyginSleigh(offset=0.0, duration=LONG, horizon=LONG)
COASTING = ChaplyginSleigh(duration=LONG, horizon=LONG)
LONG_SAMPLES = 1000
STRAIGHT_BACK = SleighBackwards(turning_rate=0.0, start=(0.0, 0.0, 0.3), duration=60.0, horizon=60.0)
ENGINES_ALONE = tuple(engine for engine in ORDINARY if engine.name != "lagrange")

FAILURES: tuple[Failure, ...] = (
    Failure(
        title="No slip at all, and a wholly wrong motion",
        expected=(
            "The blade's force turns the body too. Whoever takes away the velocity across the blade, but not the "
            "turning that goes with it, gets no slip, and the motion of another body."
        ),
        cells=_cells(ChaplyginSleigh(), (*NAIVE, method("pymunk skate: impulse at the blade")), (1, 10, 100)),
        columns=MOTION,
        remark=(
            "No slip does not prove a right motion. To set the centre's velocity across the blade to zero is right "
            "only for a blade under the centre of mass. To shift the whole velocity until the blade's point has no "
            "slip adds energy from nowhere. The third method does the same with an impulse at the blade, and costs one "
            "line more."
        ),
    ),
    Failure(
        title="The sleigh run backwards",
        expected=(
            "With the centre of mass behind the skate a small turning grows as "
            rf"$e^{{{SleighBackwards().growth_rate():g}\,t}}$ until the sleigh has turned round. Measured are the "
            f"growth between {GROWING[0]:g} and {GROWING[1]:g} rad/s, and the time at which it turns fastest."
        ),
        tasks=tuple(map(Motion, TURNING_ROUND)),
        observations=backwards,
        remark=(
            "A row that is a little late makes the growth a little too slow, and the sleigh turns round a little too "
            "late. MuJoCo's tendon at the predicted pose (`mujoco tuned`) is a little early instead. The naive "
            "zeroing, which is `pymunk default` too, does not turn round at all: the simulation hides the instability."
        ),
    ),
    Failure(
        title="Straight back, for a minute",
        expected="Without any turning the sleigh slides straight on, though unstable. Only rounding can turn it.",
        cells=_cells(STRAIGHT_BACK, ENGINES_ALONE, (1,), 600),
        columns=MOTION,
        remark=(
            "Rounding of 1e-17 rad/s grows to 1 rad/s in about "
            f"{np.log(1e17) / SleighBackwards().growth_rate():.0f} s. "
            "A method that ends elsewhere is not wrong: the question has no stable answer. A method goes straight on "
            "if its row has no rounding at this heading or, as with the naive zeroing, if it has no instability."
        ),
    ),
    Failure(
        title="Coasting for 1000 s",
        expected=(
            "The sleigh slides straight after some seconds; its heading and energy are the closed form's for ever."
        ),
        cells=_cells(COASTING, ENGINES_ALONE, (20,), LONG_SAMPLES),
        columns=MOTION,
        remark=(
            "Once the sleigh slides straight, a projection loses nothing any more. Its heading keeps the error of the "
            "first seconds, and the error of the position grows with time."
        ),
    ),
    Failure(
        title="Circling for 1000 s",
        expected=(
            "With the skate under the centre of mass the sleigh goes round a circle at an even rate for ever: "
            f"{CIRCLING.turning_rate * LONG:.0f} rad, and every centripetal force is the skate's."
        ),
        cells=_cells(CIRCLING, ENGINES_ALONE, (20,), LONG_SAMPLES),
        columns=MOTION,
        remark=(
            r"In a step $h$ the blade turns by $\omega h$. The naive zeroing projects the velocity onto the blade's "
            r"new direction, and so loses the part $(\omega h)^2 / 2$ of the speed in every step. A row that is held "
            "at the end of a step does the same. The energy shows it on a circle, but not on a sleigh that straightens."
        ),
    ),
    Failure(
        title="Friction too low to hold",
        expected=(
            "A real blade holds only so much. The ideal force says when it would slip: the first time that it exceeds "
            f"the limit, on the sleigh that turns round (at most {PEAK:.3f} N). Until then nothing differs from the "
            "ideal skate, after it everything may."
        ),
        tasks=tuple(Motion(cell) for cells in LIMITED.values() for cell in cells),
        observations=slipping,
        words=delays,
        remark=(
            "So the reaction in a run with an ideal skate tells whether a real blade would hold. An engine's friction "
            "with that limit tells it too, unless the friction creeps by itself as much as it slips. Both "
            "engines here slip {% filter if_measured %}{{ least | number }} to {{ most | number }} s {% endfilter %}"
            "after the exact force passes the limit, since the slip has to grow before it is counted."
        ),
    ),
    Failure(
        title="At rest across a slope",
        expected="An ideal skate at zero speed holds as much as it must. Nothing turns it: it rests for ever.",
        cells=_cells(SkateOnSlope(), ENGINES_ALONE, (1, 10)),
        columns=("position", "slip", "reaction"),
        remark=(
            "A soft row creeps: its force needs a slip to exist. MuJoCo's friction is soft too and creeps, as its "
            "documentation says ([Modeling, 'Slow slippage'](https://mujoco.readthedocs.io/en/stable/modeling.html)). "
            "In `mujoco default` it is not seen. The reason is this blade's friction, 1e-5 along and 10 across, as in "
            "the maintainers' example for skating ([mujoco#67](https://github.com/google-deepmind/mujoco/issues/67)). "
            "MuJoCo scales the softness of the row across by the square of their ratio, 1e-12 "
            "([engine_core_constraint.c](https://github.com/google-deepmind/mujoco/blob/main/src/engine/"
            "engine_core_constraint.c)). With equal coefficients it creeps; `noslip_iterations` takes nearly all of "
            "that away. The naive zeroing (`pymunk default`) is right here, where nothing turns."
        ),
    ),
    Failure(
        title="Turning on a slope",
        expected="The skate that turns evenly slides in cycloids, sideways and never down (the picture above).",
        cells=_cells(SkateOnSlope(turning_rate=2.0), ENGINES_ALONE, (1, 10)),
        columns=MOTION,
    ),
    Failure(
        title="Counting freedoms of skates on one body",
        expected=(
            "Freedoms are counted twice. The rank of the rows gives those of configuration and of velocity. Brackets "
            "say whether the rows are integrable together, and how many freedoms of configuration can then be reached."
        ),
        observations=counting,
        remark=(
            "Two skates never fix a body. It still turns about the point where their axles meet, or moves straight "
            "where the axles are parallel. Two in one line can only go straight: their rows are integrable together, "
            "though neither is alone. Whoever counts joints as 'holonomic' one by one finds three freedoms of "
            "configuration where one can be reached. A pin and a skate off it, or three skates, leave no freedom of "
            "velocity: the body stays where it was put, and it could have been put anywhere."
        ),
    ),
    Failure(
        title="Held by three skates on a slope",
        expected="No freedom of velocity is left: the body stays. The three rows are independent: forces are known.",
        cells=_cells(HeldBySkates(), ENGINES_ALONE, (1, 10)),
        columns=("position", "angle", "slip", "reaction"),
        remark=(
            "The skates constrain its velocity and not its place. So every slip that a method leaves adds up, and no "
            "engine can notice it."
        ),
    ),
)
