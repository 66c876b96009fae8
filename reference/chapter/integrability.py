"""Integrability of a mechanism's velocity rows by Frobenius' theorem.

The rows J(q) dq - rate dt are one-forms w_i in q and t. The motions that the rows allow are the null space D of the
rows. By Frobenius' theorem the rows are integrable if and only if dw_i(X, Y) = 0 for all X, Y in D, that is, if
brackets of allowed motions are allowed motions. Exactness, dw = 0, is sufficient but not necessary. So the argument of
box 18.3, that no F exists, proves nothing: a row may be integrable after division by a factor, or together with other
rows. Brackets that are not in D are added to D until the dimension no longer grows. That dimension is the number of
configuration freedoms (Chow's theorem); dim D is the number of velocity freedoms.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism, validated
from reference.mechanism import Mechanism
from reference.plane import COMPLEX_STEP
from reference.reactions import RANK_TOLERANCE
from reference.validators import Array, of_shape

Place = Annotated[Array, of_shape("coordinates")]
Rows = Callable[[NDArray[Any]], NDArray[Any]]  # (..., coordinates) -> (..., rows, coordinates), analytic

# Derivatives of brackets are computed by Cauchy's formula on a circle. The error is about (CIRCLE_RADIUS / distance to
# a singularity)^CIRCLE_SAMPLES.
CIRCLE_RADIUS = 0.03
CIRCLE_SAMPLES = 8
GROWTH_TOLERANCE = 1e-6
# Ranks must be equal at the pose and at NEIGHBOURS - 1 poses at this distance from the pose.
NEIGHBOUR_DISTANCE = 0.1
NEIGHBOURS = 4


@validated
def null_space(rows: Annotated[Array, of_shape("rows", "coordinates")]) -> Array:
    """An orthonormal basis (coordinates, freedoms) of the motions that rows (rows, coordinates) allow."""
    _, singular, right = np.linalg.svd(np.atleast_2d(rows))
    rank = int(np.sum(singular > RANK_TOLERANCE * max(float(singular[0]) if singular.size else 0.0, 1.0)))
    return right[rank:].T


@validated
def exterior_derivatives(rows: Rows, place: Place) -> Array:
    """dw_i = d_j w_ik - d_k w_ij (rows, coordinates, coordinates) of the one-forms w_i at a place, by complex step."""
    shifted = place + 1j * COMPLEX_STEP * np.eye(len(place))
    # (rows, j, k)
    slope = np.stack([np.imag(rows(shifted_place)) / COMPLEX_STEP for shifted_place in shifted], axis=1)
    return slope - np.swapaxes(slope, 1, 2)


@validated
def obstruction(rows: Rows, place: Place) -> Array:
    """dw_i(X_a, X_b) (rows, freedoms, freedoms) on a basis of allowed motions, zero everywhere iff integrable."""
    basis = null_space(rows(place))
    return np.einsum("ijk,ja,kb->iab", exterior_derivatives(rows, place), basis, basis)


def _neighbours(place: Place) -> list[Array]:
    number = np.arange(1, NEIGHBOURS)
    angles = np.outer(number, np.arange(1, len(place) + 1)) * np.sqrt(2.0) + number[:, None]
    return [place, *(place + NEIGHBOUR_DISTANCE * np.sin(angles))]


@validated
def is_integrable(rows: Rows, place: Place) -> bool:
    """Whether dw_i(X_a, X_b) is zero at and near a place. Raises InvalidMechanism if the rank changes near the
    place."""
    places = _neighbours(place)
    ranks = {null_space(rows(near)).shape[1] for near in places}
    if len(ranks) > 1:
        raise InvalidMechanism(
            "integrability: the rows' rank changes near this pose (a singular position); choose a pose away from it"
        )
    return all(np.abs(obstruction(rows, near)).max(initial=0.0) < GROWTH_TOLERANCE for near in places)


def _along(field: Rows, place: NDArray[Any], direction: NDArray[Any]) -> NDArray[Any]:
    turns = np.exp(2j * np.pi * np.arange(CIRCLE_SAMPLES) / CIRCLE_SAMPLES)
    circle = place[..., None, :] + CIRCLE_RADIUS * turns[:, None] * direction[..., None, :]
    return np.einsum("...pi,p->...i", field(circle), 1 / turns) / (CIRCLE_SAMPLES * CIRCLE_RADIUS)


def _bracket(first: Rows, second: Rows) -> Rows:
    return lambda place: _along(second, place, first(place)) - _along(first, place, second(place))


def _fields(rows: Rows, place: Place) -> list[Rows]:
    """Analytic fields that span the allowed motions near a place, by projection of the null space at the place."""
    from scipy.linalg import qr

    at_place = rows(place)
    _, upper, pivot = qr(at_place.T, mode="economic", pivoting=True)  # pyright: ignore[reportAssignmentType]
    diagonal = np.abs(np.diag(upper))
    rank = int(np.sum(diagonal > RANK_TOLERANCE * max(float(diagonal.max(initial=0.0)), 1.0)))
    independent = np.sort(pivot[:rank])

    def projected(motion: Array) -> Rows:
        def field(at: NDArray[Any]) -> NDArray[Any]:
            forms = rows(at)[..., independent, :]
            square = forms @ np.swapaxes(forms, -1, -2)  # analytic, not conjugated
            correction = np.swapaxes(forms, -1, -2) @ np.linalg.solve(square, (forms @ motion)[..., None])
            return motion - correction[..., 0]

        return field

    return [projected(motion) for motion in null_space(at_place).T]


@validated
def growth(rows: Rows, place: Place) -> tuple[int, ...]:
    """The dimensions of D, D + [D, D], D + [D, D] + [D, [D, D]] and so on at a place, until they no longer grow.

    The first number counts velocity freedoms, and the last number counts configuration freedoms. Examples are (1,) for
    a pinned body, (2, 3) for a skate, (2, 3, 4) for a car with a steered wheel. The place must be regular. A trailer at
    a right angle to its car is not, since a bracket vanishes only there.
    """
    generators = _fields(rows, np.asarray(place, dtype=float))
    basis = _extended_basis(np.zeros((len(place), 0)), [np.real(field(place)) for field in generators])
    dimensions, latest = [basis.shape[1]], generators
    while dimensions[-1] < len(place):
        added: list[Rows] = []
        for index, field in enumerate(generators):
            for other in latest[index + 1 :] if latest is generators else latest:
                candidate = _bracket(field, other)
                wider = _extended_basis(basis, [np.real(candidate(place))])
                if wider.shape[1] > basis.shape[1]:
                    basis = wider
                    added.append(candidate)
        if not added:
            break
        dimensions.append(basis.shape[1])
        latest = added
    return tuple(dimensions)


def _extended_basis(basis: Array, vectors: list[Array]) -> Array:
    for vector in vectors:
        rest = vector - basis @ (basis.T @ vector)
        rest -= basis @ (basis.T @ rest)
        size = float(np.linalg.norm(rest))
        if size > GROWTH_TOLERANCE * (1 + float(np.linalg.norm(vector))):
            basis = np.column_stack([basis, rest / size])
    return basis


@validated
def mechanism_rows(mechanism: Mechanism) -> Rows:
    """The one-forms of a mechanism's rows in (q, t), in units of the mechanism's length and time."""
    scale = np.tile(mechanism.pose_unit, len(mechanism.bodies))
    rate = -mechanism.rate * mechanism.time_scale

    def rows(place: NDArray[Any]) -> NDArray[Any]:
        pose = (place[..., :-1] * scale).reshape((*place.shape[:-1], -1, 3))
        forms = mechanism.rows(pose) * scale
        prescribed = np.broadcast_to(rate[:, None], (*forms.shape[:-1], 1))
        both = np.concatenate([forms, prescribed], axis=-1)
        return both / sizes

    sizes = np.linalg.norm(mechanism.rows(mechanism.pose) * scale, axis=-1)[:, None]
    return rows


def _start_of(mechanism: Mechanism) -> Array:
    return np.append((mechanism.pose / mechanism.pose_unit).ravel(), 0.0)


@validated
def mechanism_is_integrable(mechanism: Mechanism) -> bool:
    return is_integrable(mechanism_rows(mechanism), _start_of(mechanism))


@validated
def freedoms_by_brackets(mechanism: Mechanism) -> tuple[int, ...]:
    """The `growth` of a mechanism's freedoms, from the velocity freedoms to the configuration freedoms.

    This is a check of `Mechanism.degrees_of_freedom`, since it does not use `holonomic`. A car with locked steering has
    one freedom of velocity and follows one curve, so the skates are integrable together. `degrees_of_freedom` counts
    four freedoms of configuration for this car, by the classes of its joints.
    """
    dimensions = growth(mechanism_rows(mechanism), _start_of(mechanism))
    return tuple(dimension - 1 for dimension in dimensions)
