"""Reactions of long chains by their band: the same as by the dense system, and the dense one where rows depend."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from reference.joints import Pin
from reference.mechanism import Mechanism
from reference.rows import banded_reaction
from reference.scenes.n_four_bar import TenFourBars
from reference.scenes.pendulum.scenes import HundredLinks, TenLinks


def displaced(mechanism: Mechanism) -> tuple[Any, Any]:
    random = np.random.default_rng(0)
    pose = mechanism.pose + 0.1 * random.normal(size=(3, *mechanism.pose.shape))
    return pose, random.normal(size=pose.shape)


@pytest.mark.parametrize("scene", [HundredLinks(), TenFourBars()], ids=["open chain", "closed chain"])
def test_the_band_gives_the_forces_that_make_the_accelerations(scene: Any) -> None:
    mechanism = scene.mechanism()
    pose, _ = displaced(mechanism)
    # Made from forces that are known: M a = f + J^T reaction, read backwards again.
    given = np.random.default_rng(1).normal(size=(3, mechanism.row_count))
    pull = np.einsum("trc,tr->tc", mechanism.rows(pose), given).reshape(pose.shape)
    found = banded_reaction(mechanism.joint_rows, pose, pull / mechanism.inertias, mechanism.inertias)
    # The condition of a hundred links' system is about 1e4: that many roundings.
    assert np.abs(found - given).max() < 1e-11
    # Free fall, added and taken away again, leaves a rounding of the accelerations.
    whole = mechanism.reaction(pose, mechanism.free_fall + pull / mechanism.inertias)
    assert np.abs(whole - found).max() < 1e-11


def test_a_pin_given_twice_falls_back_to_the_smallest_forces() -> None:
    mechanism = TenLinks().mechanism()
    last = mechanism.joints[-1]
    assert isinstance(last, Pin)
    again = [replace(last, name="again"), replace(last, name="and again")]
    redundant = replace(mechanism, joints=(*mechanism.joints, *again))
    pose, acceleration = displaced(redundant)
    assert np.isnan(banded_reaction(redundant.joint_rows, pose, acceleration, redundant.inertias)).any(axis=1).all()
    once, shared = mechanism.reaction(pose, acceleration), redundant.reaction(pose, acceleration)
    # Of three equal rows each carries a third; the smallest singular values are cut at 1e-9.
    assert np.abs(shared[:, -2:] - shared[:, -6:-4]).max() < 1e-8 * np.abs(once).max()
    assert np.abs(3 * shared[:, -2:] - once[:, -2:]).max() < 1e-6 * np.abs(once).max()


def with_a_pin_beside_the_last(distance: float) -> Mechanism:
    """Ten links, the last on two pins this far apart [m]: their rows differ by as much where the angles do."""
    mechanism = TenLinks().mechanism()
    last = mechanism.joints[-1]
    assert isinstance(last, Pin)
    (x1, y1), (x2, y2) = last.first_point, last.second_point
    beside = replace(last, name="beside", first_point=(x1, y1 + distance), second_point=(x2, y2 + distance))
    return replace(mechanism, joints=(*mechanism.joints, beside))


def test_two_pins_a_micrometre_apart_fall_back_to_the_dense_system_which_keeps_their_digits() -> None:
    nearly = with_a_pin_beside_the_last(1e-6)
    pose, _ = displaced(nearly)
    given = np.random.default_rng(1).normal(size=(3, nearly.row_count))
    pull = np.einsum("trc,tr->tc", nearly.rows(pose), given).reshape(pose.shape)
    # The band's factorisation would end, with pivots of 1e-12: the product J M^-1 J^T has the rows' condition squared.
    assert np.isnan(banded_reaction(nearly.joint_rows, pose, pull / nearly.inertias, nearly.inertias)).any(axis=1).all()
    # The rows' own condition is 6e7: that many roundings are 1e-8, and the product would leave no digit at all.
    assert np.abs(nearly.reactions_of(pose, pull / nearly.inertias, nearly.inertias) - given).max() < 1e-6


def test_two_pins_closer_than_the_rank_can_tell_share_the_force() -> None:
    dependent = with_a_pin_beside_the_last(1e-11)
    pose, acceleration = displaced(dependent)
    assert np.isnan(banded_reaction(dependent.joint_rows, pose, acceleration, dependent.inertias)).any(axis=1).all()
    once, shared = TenLinks().mechanism().reaction(pose, acceleration), dependent.reaction(pose, acceleration)
    assert np.abs(shared).max() < 2 * np.abs(once).max()
    assert np.abs(shared[:, -4:-2] + shared[:, -2:] - once[:, -2:]).max() < 1e-6 * np.abs(once).max()
