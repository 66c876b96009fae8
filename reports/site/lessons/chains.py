"""The lesson on open and closed chains, with a double pendulum and a person on one foot or on two feet."""

from __future__ import annotations

from reference.scenes.person import SEGMENT_NAMES, OneFoot, TwoFeet
from reports.site.lesson import BOTH, Claim, Experiment, Guess, Lesson
from reports.site.lessons.linkages import JOINTS_OPEN, PENDULUM
from reports.site.live.sliders import Live, Point

_PERSON = OneFoot()
_FAR: tuple[Point, ...] = tuple(
    (float(length - behind), 0.0) for length, behind in zip(_PERSON.lengths, _PERSON._behind, strict=True)
)
ONE = Live(
    "on one foot",
    _PERSON,
    (50, 100, 200, 500, 1000),
    50,
    0,
    ends={SEGMENT_NAMES[2]: (_FAR[2],), SEGMENT_NAMES[4]: (_FAR[4],)},
    traces=((SEGMENT_NAMES[2], _FAR[2]),),
)
TWO = Live(
    "on two feet",
    TwoFeet(),
    (60, 120, 300, 600, 1200),
    60,
    0,
    ends={SEGMENT_NAMES[2]: (_FAR[2],)},
    traces=((SEGMENT_NAMES[2], _FAR[2]),),
)
RK4 = {"integrator": 1}

CHAINS = Lesson(
    "chains",
    "Open and closed chains",
    "person",
    (PENDULUM.scene("two links"), ONE, TWO),
    (
        Experiment("two links", BOTH),
        Experiment(
            "on one foot",
            RK4,
            {"steps": 500},
            (Claim("mujoco", most=1e-3), Claim("munk", most=0.3)),
            guesses=(Guess(times={"mujoco": 0.1}), Guess(times={"mujoco": 1.0}), Guess()),
        ),
        Experiment(
            "on two feet",
            RK4,
            {"steps": 600},
            (Claim("mujoco", 0.9, 1.1), Claim("munk", most=0.3)),
            (({"timeConstant": 0.002, "impedance": 0.9999}, Claim("mujoco", most=0.1)),),
            section="One foot and two",
            guesses=(Guess(times={"mujoco": 1.0}), Guess(times={"mujoco": 0.1}), Guess(times={"mujoco": 1e-3})),
        ),
        Experiment(
            "on two feet",
            after=BOTH,
            claims=(Claim("mujoco", most=1e-3), Claim("munk", 0.7, 1.1), Claim("munk", most=0.1, of="gap")),
            section="Which setting for which accuracy",
            guesses=(Guess(times={"munk": 0.1, "mujoco": 0.1}), Guess(times={"munk": 1e-3, "mujoco": 1.0}), Guess()),
            quantities=(JOINTS_OPEN,),
        ),
    ),
)
