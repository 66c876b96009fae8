"""Tests that the gates detect each wrong number in an engine's model, or that there is a reason why not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, cast

import pytest

from engines import Engine, mujoco, pymunk
from engines.lagrange import Lagrange
from reference.scene import Scene
from reference.scenes.catalogue import SCENES
from reference.scenes.pendulum.link import BarPendulum, PointPendulum
from reports.model.outcomes import Loss
from reports.run.supervisor import supervise
from reports.run.worker import worker_count
from tests.wrong.mistakes import NUMBER_KINDS, Mistake, MistakeTrial, Sighting, mistakes, noticed

# Relative mistakes that have to be noticed: 1e-4 by methods that reach rounding, 1e-2 with documented settings.
EXTENDED: dict[Engine, float] = {pymunk.EXTENDED: 1e-4, mujoco.EXTENDED: 1e-4}
OTHERS: dict[Engine, float] = {Lagrange("rk4", "projection"): 1e-4, pymunk.TUNED: 1e-2, mujoco.TUNED: 1e-2}
# Limit of the estimated CPU time [s] for a run with a wrong model. The coarsest step is always tried. The exact solver
# has a higher limit, since it is interpreted.
LIMIT, CONTROL_LIMIT = 0.15, 1.3

# A mistake has no effect if it changes an error by less than this fraction of the mistake. Forces are differences of
# velocities over a step, so their rounding error is about 1e-7; the smallest mistake is 1e-4.
NOTHING = 0.01

# Scenes that are too long for every mistake, or in which right models fail before their end [s].
DURATIONS = {
    "point_pendulum": 2.0,  # With the steps of the grid, the phase is lost before the end at 2000 s.
    # The motion ends before the first singular position, where right models diverge from each other.
    "n_four_bar_2": 0.3,
    "n_four_bar_10": 0.3,
    "n_four_bar_40": 0.2,
    "pendulum_10": 1.0,
    "pendulum_100": 0.1,
    "elliptic_gears": 0.4,
    "rolling_in_ring": 1.0,
}

ALONG_THE_AXLE = (
    "every point across a blade has the same velocity across it: the place along an axle is no number of it"
)
STEADY = "this body turns at a constant rate, or not at all, so that no force depends on its inertia"
FALLING = "in the time that is run these links fall without turning yet"
ALONG_THE_SLOT = "a line has no places: its point, moved along it, gives the same line"
SLIDER = (
    "the slider can't turn, so where the slot holds it changes no motion; and reactions are read from accelerations, "
    "at the place where the mechanism has the slot"
)
NO_TORQUE = (
    "the slider can't turn, so where the slot holds it changes no motion, only the torque that keeps it level; that is "
    "zero here, and the one torque there is, so that its error has no scale and is not measured"
)
PRESCRIBED = "pymunk moves this body as prescribed and has no number for its mass"

# (scene, mistake) -> the reason why this mistake has no effect.
UNNOTICEABLE: dict[tuple[str, str], str] = {
    ("driven_four_bar", "inertia crank"): STEADY,
    ("driven_slider_crank", "inertia crank"): STEADY,
    ("driven_slider_crank", "inertia slider"): STEADY,
    ("free_slider_crank", "inertia slider"): STEADY,
    ("elliptic_gears", "inertia first"): STEADY,
    ("pinned_body_free", "inertia body"): STEADY,
    **{("pendulum_100", f"inertia link {n}"): FALLING for n in (51, 100)},
    **{("n_four_bar_2", f"inertia coupler {n}"): STEADY for n in (0, 1)},
    **{("n_four_bar_10", f"inertia coupler {n}"): STEADY for n in (9,)},
    **{("n_four_bar_40", f"inertia coupler {n}"): STEADY for n in (39,)},
    **{(f"{kind}_slider_crank", "point guide first_point x"): ALONG_THE_SLOT for kind in ("driven", "free")},
    **{(scene, "point skate second_point y"): ALONG_THE_AXLE for scene in ("sleigh", "sleigh_backwards")},
    **{("car_and_trailer", f"point {body}'s axle second_point y"): ALONG_THE_AXLE for body in ("car", "trailer")},
    ("cart", "point axle second_point y"): ALONG_THE_AXLE,
    **{("cart", f"point {side} caster's wheel second_point y"): ALONG_THE_AXLE for side in ("left", "right")},
}
# (scene, engine, mistake) -> the reason why this mistake has no effect in this engine.
UNNOTICEABLE_IN: dict[tuple[str, str, str], str] = {
    ("driven_four_bar", "pymunk", "mass crank"): PRESCRIBED,
    ("driven_slider_crank", "pymunk", "mass crank"): PRESCRIBED,
    ("elliptic_gears", "pymunk", "mass first"): PRESCRIBED,
    **{
        (f"{kind}_slider_crank", engine, "point guide second_point x"): SLIDER
        for kind in ("driven", "free")
        for engine in ("pymunk", "mujoco")
    },
    ("free_slider_crank", "lagrange", "point guide second_point x"): NO_TORQUE,
}

# Reasons why the bounds from theory do not detect some mistakes. The comparison with the baseline detects these
# mistakes, since without a mistake only rounding changes an error.
FORCES = "the mistake shows in forces alone, and in a part of them that is smaller than what theory allows this order"
COARSE = "of first order: at the finest step that is run its own error is as large as what the mistake makes"
POLYGON = "a body that is not round is a polygon here, and its blows are larger than what the mistake makes"
PRESSED = "pins already hold the gears apart: how hard they press is a matter of softness, of which nothing is promised"
# Some mistakes with the reason SWEPT do not change the digits that the baseline compares.
SWEPT = "its sweeps do not converge on so many joints, so that its own error is larger than what the mistake makes"

LARGER: dict[tuple[str, str], str] = {
    **{(scene, "pymunk extended"): SWEPT for scene in ("pendulum_100", "n_four_bar_40")},
    ("driven_slider_crank", "pymunk tuned"): FORCES,
    ("pinned_body_free", "pymunk tuned"): FORCES,
    **{(scene, f"{name} tuned"): COARSE for scene in ("car_and_trailer", "cart") for name in ("pymunk", "mujoco")},
    ("free_slider_crank", "pymunk tuned"): COARSE,
    **{("elliptic_gears", f"{name} tuned"): PRESSED for name in ("pymunk", "mujoco")},
    **{(f"rolling_{curve}", "pymunk tuned"): POLYGON for curve in ("ellipse", "cam", "incline")},
    **{(scene, "pymunk tuned"): SWEPT for scene in ("pendulum_100", "n_four_bar_10", "n_four_bar_40")},
}


@dataclass(frozen=True)
class SampledPointPendulum(PointPendulum):
    """The point pendulum with the sampling of the bar pendulum, since its usual samples are half a second apart."""

    samples = BarPendulum.samples  # pyright: ignore[reportIncompatibleMethodOverride, reportAssignmentType]


def short(scene: Scene) -> Scene:
    """The scene with its duration in DURATIONS, if there is one."""
    duration = DURATIONS.get(scene.name)
    if duration is None:
        return scene
    if isinstance(scene, PointPendulum):
        scene = SampledPointPendulum()
    # Scenes of rolling bodies compute their horizon; other scenes have it as a field.
    horizon_field = {"horizon": min(duration, scene.horizon)} if "horizon" in scene.__dataclass_fields__ else {}  # pyright: ignore[reportAttributeAccessIssue]
    return replace(cast(Any, scene), duration=duration, **horizon_field)


def excuse(scene: Scene, engine: Engine, mistake: Mistake) -> str:
    """The reason why a mistake has no effect, or "" if it must be detected."""
    expected = UNNOTICEABLE.get((scene.name, str(mistake)), "")
    return expected or UNNOTICEABLE_IN.get((scene.name, engine.name, str(mistake)), "")


@cache
def all_mistakes(scene: Scene) -> tuple[Mistake, ...]:
    return mistakes(scene.mechanism())


def limit(scene: Scene) -> float:
    """Andrews' spring is so stiff that at its two coarsest steps a method's own error hides the effect of a mistake."""
    return 2 * LIMIT if scene.name == "andrews" else LIMIT


def whole(engines: Mapping[Engine, float]) -> list[MistakeTrial]:
    return [
        MistakeTrial(
            short(scene),
            engine,
            relative,
            all_mistakes(scene),
            CONTROL_LIMIT if engine.name == "lagrange" else limit(scene),
        )
        for scene in SCENES
        for engine, relative in engines.items()
    ]


def representative(trials: Iterable[MistakeTrial], each: int = 1) -> list[MistakeTrial]:
    """The trials with at most `each` mistakes of different kinds. Mistakes with an excuse are left out, and kinds that
    are rare in the engine's earlier trials are preferred."""
    met: dict[str, Counter[str]] = {}
    out = []
    for trial in trials:
        counts = met.setdefault(trial.engine.name, Counter())
        last = {mistake.kind: mistake for mistake in trial.mistakes if not excuse(trial.scene, trial.engine, mistake)}
        rarest = sorted(last, key=lambda kind: (counts[kind], NUMBER_KINDS.index(kind)))[:each]
        counts.update(rarest)
        out.append(replace(trial, mistakes=tuple(last[kind] for kind in rarest)))
    return out


# Slow scenes that only the slow test runs, since faster scenes have the same kinds of joints and numbers.
LONGER = ("spinning_four_bar", "pendulum_100", "n_four_bar_40", "andrews", "rolling_in_ring")

_shorter = [trial for trial in whole(EXTENDED) if trial.scene.name not in LONGER]
# Scenes alternate between the two engines.
REPRESENTATIVE = representative(trial for number, trial in enumerate(_shorter) if number % 4 in (0, 3))
EVERYTHING = whole({**EXTENDED, **OTHERS})
Findings = Mapping[tuple[str, str], Mapping[Mistake, Sighting] | Loss]


def found(trials: Iterable[MistakeTrial]) -> Findings:
    """The effects of the mistakes by scene and method, computed in supervised processes."""
    by_scene: dict[str, list[MistakeTrial]] = {}
    for trial in trials:
        by_scene.setdefault(trial.scene.name, []).append(trial)
    # The limit [s] allows forty runs of a hundred bodies with each of two engines on a loaded machine.
    reported = supervise(noticed, map(tuple, by_scene.values()), limit=600.0, workers=worker_count())
    return {
        (trial.scene.name, trial.method): result if isinstance(result, Loss) else result[index]
        for trials_of_method, result, _ in reported
        for index, trial in enumerate(trials_of_method)
    }


@pytest.fixture(scope="session")
def findings() -> Findings:
    return found(REPRESENTATIVE)


@pytest.fixture(scope="session")
def all_findings(request: pytest.FixtureRequest) -> Findings:
    if "slow" not in str(request.config.getoption("markexpr")):
        pytest.skip("every mistake in every variant takes ten minutes: pytest -m slow -k wrong_models")
    return found(EVERYTHING)


def named(trials: Iterable[MistakeTrial]) -> list:
    return [pytest.param(trial, id=f"{trial.scene.name}-{trial.method}") for trial in trials]


def unseen(trial: MistakeTrial, findings: Findings) -> list[str]:
    """The mistakes that no bound from theory detects. Asserts that a mistake has an effect unless it is excused."""
    result = findings[trial.scene.name, trial.method]
    assert not isinstance(result, Loss), result
    out = []
    for mistake, sighting in result.items():
        if excuse(trial.scene, trial.engine, mistake):
            assert sighting.shift < NOTHING * trial.relative, f"{mistake} changes an error by {sighting.shift:.1g}"
            continue
        # The comparison with the baseline must detect the mistake even if the bounds from theory do not.
        drowned = LARGER.get((trial.scene.name, trial.method)) == SWEPT
        assert sighting.changed or drowned, f"{mistake} changes nothing, so it needs a reason of its own"
        if not sighting.check:
            out.append(str(mistake))
    return out


@pytest.mark.parametrize("trial", named(REPRESENTATIVE))
def test_a_number_that_is_wrong_in_an_engine_alone_is_noticed(findings: Findings, trial: MistakeTrial) -> None:
    """This test makes a mistake in each fast scene; the slow test makes all mistakes in all scenes."""
    assert not unseen(trial, findings) or (trial.scene.name, trial.method) in LARGER


@pytest.mark.slow
@pytest.mark.parametrize("trial", named(EVERYTHING))
def test_every_number_that_is_wrong_in_an_engine_alone_is_noticed(all_findings: Findings, trial: MistakeTrial) -> None:
    rest = unseen(trial, all_findings)
    if (trial.scene.name, trial.method) in LARGER:
        assert rest, "every mistake is noticed: take it out of LARGER"
    else:
        assert not rest


def test_every_reason_names_a_real_mistake_and_method() -> None:
    possible = {(scene.name, str(mistake)) for scene in SCENES for mistake in all_mistakes(scene)}
    assert set(LONGER) <= {scene.name for scene in SCENES}
    assert set(UNNOTICEABLE) <= possible
    assert {(scene, mistake) for scene, _, mistake in UNNOTICEABLE_IN} <= possible
    assert {engine for _, engine, _ in UNNOTICEABLE_IN} <= {trial.engine.name for trial in EVERYTHING}
    assert set(LARGER) <= {(trial.scene.name, trial.method) for trial in EVERYTHING}
