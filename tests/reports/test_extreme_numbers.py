"""Numbers of a scene that are valid each and have no finite motion together are refused by name, in one place."""

from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.numerics.integration import IntegrationFailed
from reference.scene import NoMotion, Scene, with_settings
from reference.trajectory import Trajectory
from reports.model.catalogue import SCENES
from reports.model.cells import Cell
from reports.model.measure import measure
from tests.reports.test_measure import Given, disc
from tests.toys import Disc

BY_NAME = {scene.name: scene for scene in SCENES}
EXTREMES = ("1e200", "1e-200", "-1", "0", "nan", "inf")


# A hundred links have the fields of ten, and take a quarter of a minute.
@pytest.mark.parametrize("scene", [scene for scene in SCENES if scene.name != "pendulum_100"], ids=lambda s: s.name)
def test_every_number_of_every_scene_gives_a_finite_start_or_a_refusal(scene: Scene):
    for field in fields(scene):  # type: ignore[arg-type]
        for text in EXTREMES:
            try:
                start = with_settings(scene, {field.name: text}).motion(0.0)
            except InvalidMechanism:
                continue
            assert np.isfinite([start.pose, start.twist]).all(), (field.name, text)


@pytest.mark.parametrize(
    ("name", "number", "text", "reason"),
    [
        ("driven_slider_crank", "rate", "1e200", "body 'crank': its kinetic energy at t = 0 is inf J"),
        ("driven_four_bar", "rate", "-1e170", "kinetic energy"),
        ("pendulum_1", "length", "1e200", "its numbers make no mechanism: .*out of range"),
        ("rolling_cam", "gyration", "1e180", "its numbers make no mechanism"),
        ("free_four_bar", "crank", "2", "at crank angle"),
        ("free_four_bar", "coupler", "1e-200", "the loop can't close"),
    ],
)
def test_settings_without_a_mechanism_are_refused_by_the_promised_exception(name, number, text, reason):
    with pytest.raises(InvalidMechanism, match=rf"(?s){reason}"):
        with_settings(BY_NAME[name], {number: text})


@pytest.mark.parametrize(
    ("name", "number", "reason"),
    [
        ("free_slider_crank", "gravity", "the motion stops"),
        ("pendulum_2", "tip", "positive definite"),
        ("cart", "trail", "the reactions that its accelerations need are not finite"),
    ],
)
def test_a_motion_that_can_not_be_computed_is_held_against_no_engine(name, number, reason):
    scene = with_settings(BY_NAME[name], {number: "1e200"})
    with pytest.raises(NoMotion, match=rf"scene '{name} {number}=1e\+200': no motion is known up to .*{reason}"):
        scene.motion(np.linspace(0.0, scene.duration, 3))


@dataclass(frozen=True)
class Wrong(Disc):
    """Somebody's scene whose truth goes wrong in one of several ways."""

    name: ClassVar[str] = "wrong"
    how: str = ""

    def _motion(self, times: np.ndarray) -> Trajectory:
        good = super()._motion(times)
        arrays = {"pose": good.pose.copy(), "twist": good.twist.copy(), "reaction": good.reaction.copy()}
        part, _, value = self.how.partition("=")
        if part in arrays:
            arrays[part][-1] = float(value)
        elif part == "raise":
            raise {"1/0": ZeroDivisionError, "diverged": IntegrationFailed}[value](value)
        return replace(good, **arrays)


@pytest.mark.parametrize(
    "how", ["pose=nan", "pose=inf", "twist=nan", "twist=1e200", "reaction=inf", "raise=1/0", "raise=diverged"]
)
def test_a_users_truth_that_is_not_finite_is_refused_by_name_and_the_engine_is_not_graded(how):
    row = measure(Cell(Wrong(how=how), Given(disc()), 1), repeat=False)
    assert row.outcome == "refused"
    assert row.sentence.startswith("scene 'wrong': no motion is known up to ")


def test_a_reaction_that_nobody_knows_is_no_refusal():
    assert measure(Cell(Wrong(how="reaction=nan"), Given(disc()), 1), repeat=False).outcome == "finished"


def test_a_scene_whose_arithmetic_fails_refuses_its_mechanism_in_words():
    @dataclass(frozen=True)
    class Heavy(Disc):
        name: ClassVar[str] = "heavy"
        radius: float = 1e200

        def mechanism(self) -> Mechanism:
            return self.radius**2  # pyright: ignore[reportReturnType]

    with pytest.raises(NoMotion, match=r"scene 'heavy': its numbers make no mechanism: .*out of range"):
        Heavy().mechanism()
