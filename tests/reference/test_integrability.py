"""Frobenius' test in numbers: which velocity rows are derivatives of positions, and how many freedoms brackets find."""

from __future__ import annotations

import numpy as np
import pytest

from reference.chapter.integrability import (
    exterior_derivatives,
    freedoms_by_brackets,
    growth,
    is_integrable,
    mechanism_is_integrable,
    obstruction,
)
from reference.checks import InvalidMechanism
from reference.joints import Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.pinned_body import PinnedBody
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart
from tests.mechanisms import four_bar

POINT = (0.4, -0.7)
PLACE = np.array([0.3, -0.2, 0.8])


def pin(place):
    """(18.62), analytic."""
    cosine, sine, one = np.cos(place[..., 2]), np.sin(place[..., 2]), 1 + 0 * place[..., 2]
    x = np.stack([one, 0 * one, -sine * POINT[0] - cosine * POINT[1]], axis=-1)
    y = np.stack([0 * one, one, cosine * POINT[0] - sine * POINT[1]], axis=-1)
    return np.stack([x, y], axis=-2)


def skate(place):
    """The one-form of (18.64) as the very combination of the pin's two."""
    cosine, sine = np.cos(place[..., 2])[..., None], np.sin(place[..., 2])[..., None]
    both = pin(place)
    return (-sine * both[..., 0, :] + cosine * both[..., 1, :])[..., None, :]


def scaled_position(place):
    """exp(x) times d(y + theta^2): one row that is not exact, and yet integrable after division by a factor."""
    factor = np.exp(place[..., 0])
    return np.stack([0 * factor, factor, 2 * place[..., 2] * factor], axis=-1)[..., None, :]


def test_the_pins_two_rows_are_exact_and_each_alone_is_integrable():
    assert np.abs(exterior_derivatives(pin, PLACE)).max() < 1e-15
    for row in (0, 1):
        assert is_integrable(lambda place, row=row: pin(place)[..., row : row + 1, :], PLACE)
    assert is_integrable(pin, PLACE)
    assert growth(pin, PLACE) == (1,)


def test_a_combination_of_the_pins_rows_is_the_skate_and_not_integrable_alone():
    """Erratum 12: the skate's row is in the span of the pin's, and only without its partner it can't be integrated."""
    expected = [-np.sin(PLACE[2]), np.cos(PLACE[2]), POINT[0]]
    assert np.abs(skate(PLACE)[0] - expected).max() < 1e-15
    assert not is_integrable(skate, PLACE)
    assert growth(skate, PLACE) == (2, 3)
    assert is_integrable(lambda place: np.concatenate([skate(place), pin(place)[..., :1, :]], axis=-2), PLACE)


def test_a_row_that_is_not_exact_may_be_integrable():
    """A test of exactness, as the box has it, would call this one nonholonomic."""
    assert np.abs(exterior_derivatives(scaled_position, PLACE)).max() > 0.1
    assert np.abs(obstruction(scaled_position, PLACE)).max() < 1e-14
    assert is_integrable(scaled_position, PLACE)
    assert growth(scaled_position, PLACE) == (2,)


def test_a_row_that_passes_at_one_place_only_is_refused():
    """w = dy + x^2 dtheta has w . curl w = 2 x: zero at x = 0, where a test at one place would be deceived."""

    def deceiving(place):
        x = place[..., 0]
        return np.stack([0 * x, 1 + 0 * x, x**2], axis=-1)[..., None, :]

    assert np.abs(obstruction(deceiving, np.zeros(3))).max() < 1e-15
    assert not is_integrable(deceiving, np.zeros(3))


@pytest.mark.parametrize(
    ("mechanism", "counted", "bracketed"),
    [
        (PinnedBody().mechanism(), (1, 1), (1,)),
        (ChaplyginSleigh().mechanism(), (3, 2), (2, 3)),
        (four_bar(), (1, 1), (1,)),
        (four_bar(1.0, 1.0), (0, 0), (0,)),
        (Cart().mechanism(), (5, 2), (2, 3, 5)),
        (Cart(redundant=True).mechanism(), (5, 2), (2, 3, 5)),
        # One freedom of velocity is one curve: skates that hold the steering can be integrated together.
        (CarAndTrailer().mechanism(), (4, 1), (1,)),
        (CarAndTrailer(redundant=True).mechanism(), (4, 1), (1,)),
    ],
    ids=["pinned", "sleigh", "four-bar", "driven four-bar", "cart", "cart, redundant", "car", "car, redundant"],
)
def test_freedoms_by_rank_and_by_brackets(mechanism, counted, bracketed):
    assert mechanism.degrees_of_freedom() == counted
    assert freedoms_by_brackets(mechanism) == bracketed
    assert bracketed[0] == counted[1]
    assert mechanism_is_integrable(mechanism) == (len(bracketed) == 1)


def test_a_steered_car_reaches_four_configurations_with_two_velocities():
    frame, wheel = Body("frame", 1.0, 1.0, (0.0, 0.0, 0.2)), Body("wheel", 1.0, 1.0, (np.cos(0.2), np.sin(0.2), 0.5))
    joints = (
        Skate("rear", None, "frame", (0.0, 0.0)),
        Pin("fork", "frame", "wheel", (1.0, 0.0), (0.0, 0.0)),
        Skate("front", None, "wheel", (0.0, 0.0)),
    )
    car = Mechanism((frame, wheel), joints)
    assert car.degrees_of_freedom() == (4, 2)
    assert freedoms_by_brackets(car) == (2, 3, 4)


def test_two_skates_in_one_line_stop_turning_and_three_askew_stop_everything():
    body = Body("body", 1.0, 1.0, (0.1, 0.2, 0.3))
    first, second = Skate("a", None, "body", (0.5, 0.0)), Skate("b", None, "body", (-0.5, 0.0))
    assert Mechanism((body,), (first, second)).degrees_of_freedom() == (3, 1)
    askew = Skate("c", None, "body", (0.0, 0.5), np.pi / 2)
    assert Mechanism((body,), (first, second, askew)).degrees_of_freedom() == (3, 0)


def test_a_change_of_rank_is_refused():
    def singular(place):
        return place[..., None, :] * np.array([1.0, 0.0, 0.0])

    with pytest.raises(InvalidMechanism, match="singular position"):
        is_integrable(singular, np.zeros(3))
