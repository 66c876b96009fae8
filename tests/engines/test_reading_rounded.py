"""Models whose file was rounded to some digits: the motion is that of the exact plane, and the effect is told."""

from __future__ import annotations

import re
from math import pi

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mujoco.reading import read
from reports.check.checked import Plan, check
from reports.check.judging import refuse_disagreement
from tests import independent

# A four-bar linkage in the plane of x and z, its bodies' own axes y in the plane; {} are a right angle as the file has
# it, the axis of a hinge, and how far beside the plane the coupler lies [m].
FOUR_BAR = """<mujoco model="four bar"><compiler angle="radian"/><option timestep="0.001"/><worldbody>
 <body name="crank" {0}><joint name="A" axis="0 0 1"/><inertial pos="0 0.15 0" mass="1" diaginertia="0.01 0.001 0.01"/>
 <body name="coupler" pos="0 0.3 {2}"><joint name="B" axis="{1} 0 1"/>
 <inertial pos="0.4 0.15 0" mass="2" diaginertia="0.02 0.2 0.19"/></body></body>
 <body name="rocker" pos="0.7 0 0" {3}><joint name="D" axis="0 0 1"/>
 <inertial pos="0.05 0.3 0" mass="1.5" diaginertia="0.05 0.001 0.05"/></body></worldbody>
 <equality><connect name="C" body1="coupler" body2="rocker" anchor="0.8 0.3 0"/></equality></mujoco>"""
EXACT = f'euler="{pi / 2!r} 0 0"'


def model_of(crank=EXACT, axis=0.0, beside=0.0, rocker=EXACT):
    return mujoco.MjModel.from_xml_string(FOUR_BAR.format(crank, axis, beside, rocker))


@pytest.fixture(scope="module")
def truth():
    t, model = np.linspace(0.0, 1.0, 21), model_of()
    return t, independent.motion(model, mujoco.MjData(model), [independent.connected("C")], t)[0]


ROUNDED = {
    "six digits of quaternions": ('quat="0.707105 0.707108 0 0"', 0.0, 0.0, 'quat="0.707108 0.707105 0 0"'),
    "1.5708 in one body": ('euler="1.5708 0 0"', 0.0, -0.1, EXACT),
    "nothing": (EXACT, 0.0, 0.3, EXACT),
}


@pytest.mark.parametrize("name", ROUNDED)
def test_a_rounded_file_moves_as_the_exact_one_and_its_effect_is_told(name, truth):
    t, coordinates = truth
    reading = read(model_of(*ROUNDED[name]))
    motion = TRUTH.build(reading.mechanism, t[1])(len(t) - 1, 1)
    angles = motion.pose[..., 2] - motion.pose[:1, :, 2]
    ours = np.column_stack([angles[:, 0], angles[:, 1] - angles[:, 0], angles[:, 2]])
    tilt = getattr(reading.model, "tilt")  # noqa: B009
    # Neighbouring starts are 30 times as far apart after a second, and what is beside the plane moves by the tilt.
    assert np.abs(np.abs(ours) - np.abs(coordinates)).max() < 30 * tilt + 1e-8
    assert refuse_disagreement(reading) < 1e-9
    found = check(reading, name, 0.5, 1e-2, plan=Plan(0.0))
    told = [note.reason for note in found.reading.notes if note.element == "the directions of joints"]
    assert len(told) == (name != "nothing")
    for words in told:
        off, *moved = (float(each) for each in re.findall(r"(\d[\d.]*e-\d+|0\.\d+) (?:m|rad)", words))
        assert off == pytest.approx(tilt, rel=0.05)
        assert 4e-8 < tilt < 1e-5
        assert max(moved[:2]) < 100 * tilt
        assert "with stiff loops by" in words


@pytest.mark.parametrize(("angle", "remedy"), [("1.57", True), ("1.3", False)])
def test_what_is_tilted_by_more_is_no_plane(angle, remedy):
    with pytest.raises(Unsupported, match="joint 'D': it is not parallel to joint 'A', but") as refused:
        read(model_of(rocker=f'euler="{angle} 0 0"'))
    assert ("with six digits or more" in str(refused.value)) is remedy
