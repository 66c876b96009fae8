"""What a user imports, and what comes with it."""

import subprocess
import sys

import pytest


def test_the_two_problems_and_parking_are_where_a_first_user_looks():
    from reference.chapter.errata.linkages import accelerations, velocities
    from reference.chapter.parking import Move, park

    assert velocities(1.0, (0.0, 0.0), (2.0, 1.0)).b == pytest.approx([3.0, 0.0])
    assert accelerations(1.0, (0.0, 0.0), (2.0, 0.0), (0.0, 0.0)).a == pytest.approx([0.0, 4.0])
    assert park((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) == (Move(0.0, 1.0), Move(0.0))


def test_a_joint_is_imported_without_any_scene():
    code = "import sys, reference.joints, reference.mechanism; print([m for m in sys.modules if 'scene' in m])"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
