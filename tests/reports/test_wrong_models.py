"""Tests that the gates detect each wrong number in an engine's model, or that there is a reason why not."""

from __future__ import annotations

import tomllib
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
from tests import ROOT
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

TABLES = tomllib.loads((ROOT / "tests/wrong/unnoticed.toml").read_text(encoding="utf-8"))
DURATIONS: dict[str, float] = TABLES["durations"]
# (scene, engine or "", mistake) of the mistakes without an effect, in this engine or in all engines.
WITHOUT_EFFECT = {
    (scene, engine, mistake)
    for entry in TABLES["without_effect"]
    for engine in entry.get("engines", [""])
    for scene, mistake in entry["mistakes"]
}
# (scene, method) -> the kind of reason why the bounds from theory do not detect some mistakes.
LARGER = {(scene, method): kind for kind, entry in TABLES["larger"].items() for scene, method in entry["cases"]}


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


def is_excused(scene: Scene, engine: Engine, mistake: Mistake) -> bool:
    """Whether a mistake has no effect, so that it can't be detected."""
    return any((scene.name, name, str(mistake)) in WITHOUT_EFFECT for name in ("", engine.name))


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
        last = {
            mistake.kind: mistake for mistake in trial.mistakes if not is_excused(trial.scene, trial.engine, mistake)
        }
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
        if is_excused(trial.scene, trial.engine, mistake):
            assert sighting.shift < NOTHING * trial.relative, f"{mistake} changes an error by {sighting.shift:.1g}"
            continue
        # The comparison with the baseline must detect the mistake even if the bounds from theory do not.
        drowned = LARGER.get((trial.scene.name, trial.method)) == "swept"
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
    assert {(scene, mistake) for scene, _, mistake in WITHOUT_EFFECT} <= possible
    assert {engine for _, engine, _ in WITHOUT_EFFECT} <= {"", *(trial.engine.name for trial in EVERYTHING)}
    assert set(LARGER) <= {(trial.scene.name, trial.method) for trial in EVERYTHING}
