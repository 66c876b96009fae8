"""Are velocity rows derivatives of positions? Frobenius' theorem on their one-forms, in numbers, for any mechanism.

The rows J(q) dq - rate dt are one-forms w_i in q and t; the motions they allow are the null space D of the rows. By
Frobenius the rows are integrable if and only if dw_i(X, Y) = 0 for all X, Y in D, that is, if brackets of allowed
motions are allowed. Exactness, dw = 0, is sufficient and not necessary, so box 18.3's 'no F exists' alone proves
nothing: a row may be integrable after division by a factor, or only together with the others. When brackets leave D,
adding them until nothing new appears gives the configurations that can be reached (Chow): dim D counts the freedoms.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from reference.checks import InvalidMechanism, validated
from reference.mechanism import Mechanism
from reference.plane import COMPLEX_STEP
from reference.rows import RANK_TOLERANCE
from reference.validators import of_shape

Array = NDArray[np.float64]
Place = Annotated[Array, of_shape("coordinates")]
Pose = Annotated[Array, of_shape("bodies", 3)]
Rows = Callable[[NDArray[Any]], NDArray[Any]]  # (..., coordinates) -> (..., rows, coordinates), analytic

# Derivatives of brackets by Cauchy's formula on a circle: the error is about (radius / distance to a
# singularity)^POINTS, and nesting works because everything stays analytic.
RADIUS = 0.03
POINTS = 8
GROWTH_TOLERANCE = 1e-6
# A rank must hold in a neighbourhood; these fixed, irrational-looking directions away from the pose test it there.
SPREAD = 0.1
PLACES = 4


@validated
def null_space(rows: Annotated[Array, of_shape("rows", "coordinates")]) -> Array:
    """An orthonormal basis (coordinates, freedoms) of the motions that rows (rows, coordinates) allow."""
    _, singular, right = np.linalg.svd(np.atleast_2d(rows))
    rank = int(np.sum(singular > RANK_TOLERANCE * max(float(singular[0]) if singular.size else 0.0, 1.0)))
    return right[rank:].T


@validated
def exterior_derivatives(rows: Rows, place: Place) -> Array:
    """dw_i (rows, coordinates, coordinates) of the one-forms w_i at a place: d_j w_ik - d_k w_ij, by complex step."""
    shifted = place + 1j * COMPLEX_STEP * np.eye(len(place))
    slope = np.stack(
        [np.imag(rows(each)) / COMPLEX_STEP for each in shifted], axis=1
    )  # (rows, by coordinate j, component k)
    return slope - np.swapaxes(slope, 1, 2)


@validated
def obstruction(rows: Rows, place: Place) -> Array:
    """dw_i(X_a, X_b) (rows, freedoms, freedoms) on a basis of allowed motions: zero everywhere iff integrable."""
    basis = null_space(rows(place))
    return np.einsum("ijk,ja,kb->iab", exterior_derivatives(rows, place), basis, basis)


def _around(place: Place) -> list[Array]:
    angles = np.outer(np.arange(1, PLACES), np.arange(1, len(place) + 1)) * np.sqrt(2.0) + np.arange(1, PLACES)[:, None]
    return [place, *(place + SPREAD * np.sin(angles))]


@validated
def is_integrable(rows: Rows, place: Place) -> bool:
    """Whether the obstruction vanishes at a place and around it. Raises InvalidMechanism where the rank changes."""
    places = _around(place)
    ranks = {null_space(rows(each)).shape[1] for each in places}
    if len(ranks) > 1:
        raise InvalidMechanism(
            "integrability: the rows' rank changes near this pose (a singular position); choose a pose away from it"
        )
    return all(np.abs(obstruction(rows, each)).max(initial=0.0) < GROWTH_TOLERANCE for each in places)


def _along(field: Rows, place: NDArray[Any], direction: NDArray[Any]) -> NDArray[Any]:
    """The derivative of an analytic field along a direction, both at places (..., coordinates), on a circle around."""
    turns = np.exp(2j * np.pi * np.arange(POINTS) / POINTS)
    circle = place[..., None, :] + RADIUS * turns[:, None] * direction[..., None, :]
    return np.einsum("...pi,p->...i", field(circle), 1 / turns) / (POINTS * RADIUS)


def _bracket(one: Rows, two: Rows) -> Rows:
    return lambda place: _along(two, place, one(place)) - _along(one, place, two(place))


def _fields(rows: Rows, place: Place) -> list[Rows]:
    """Analytic fields that span the allowed motions near the place: its null space, projected along the motion."""
    here = rows(place)
    _, upper, pivot = qr(here.T, mode="economic", pivoting=True)  # pyright: ignore[reportAssignmentType]
    diagonal = np.abs(np.diag(upper))
    rank = int(np.sum(diagonal > RANK_TOLERANCE * max(float(diagonal.max(initial=0.0)), 1.0)))
    kept = np.sort(pivot[:rank])

    def projected(motion: Array) -> Rows:
        def field(at: NDArray[Any]) -> NDArray[Any]:
            forms = rows(at)[..., kept, :]
            square = forms @ np.swapaxes(forms, -1, -2)  # transposed, not conjugated: it must stay analytic
            correction = np.swapaxes(forms, -1, -2) @ np.linalg.solve(square, (forms @ motion)[..., None])
            return motion - correction[..., 0]

        return field

    return [projected(motion) for motion in null_space(here).T]


@validated
def growth(rows: Rows, place: Place) -> tuple[int, ...]:
    """The dimensions of D, D + [D, D], D + [D, D] + [D, [D, D]], ... at a place, until nothing is added.

    The first is the number of velocity freedoms, the last that of configuration freedoms: (1,) for a pinned body,
    (2, 3) for a skate, (2, 3, 4) for a car with a steered wheel. The place must be regular: where a bracket vanishes at
    this place only (a trailer square to its car) its own brackets are not followed.
    """
    generators = _fields(rows, np.asarray(place, dtype=float))
    known = _rank_basis(np.zeros((len(place), 0)), [np.real(field(place)) for field in generators])
    dimensions, latest = [known.shape[1]], generators
    while dimensions[-1] < len(place):
        found: list[Rows] = []
        for index, field in enumerate(generators):
            for other in latest[index + 1 :] if latest is generators else latest:
                candidate = _bracket(field, other)
                wider = _rank_basis(known, [np.real(candidate(place))])
                if wider.shape[1] > known.shape[1]:
                    known = wider
                    found.append(candidate)
        if not found:
            break
        dimensions.append(known.shape[1])
        latest = found
    return tuple(dimensions)


def _rank_basis(known: Array, vectors: list[Array]) -> Array:
    """An orthonormal basis (coordinates, dimension) of what is known and of the vectors that are new to it."""
    for vector in vectors:
        rest = vector - known @ (known.T @ vector)
        rest -= known @ (known.T @ rest)
        size = float(np.linalg.norm(rest))
        if size > GROWTH_TOLERANCE * (1 + float(np.linalg.norm(vector))):
            known = np.column_stack([known, rest / size])
    return known


@validated
def mechanism_rows(mechanism: Mechanism) -> Rows:
    """The one-forms of a mechanism's rows in (q, t), lengths and time in units of its own scales."""
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


@validated
def mechanism_place(mechanism: Mechanism, pose: Pose | None = None) -> Array:
    """The coordinates of `mechanism_rows` for a pose (bodies, 3), the start unless given."""
    pose = mechanism.pose if pose is None else pose
    return np.append((pose / mechanism.pose_unit).ravel(), 0.0)


@validated
def mechanism_is_integrable(mechanism: Mechanism, pose: Pose | None = None) -> bool:
    """Whether all rows together are derivatives of positions (and time), near a pose, the start unless given."""
    return is_integrable(mechanism_rows(mechanism), mechanism_place(mechanism, pose))


@validated
def freedoms_by_brackets(mechanism: Mechanism, pose: Pose | None = None) -> tuple[int, ...]:
    """The growth of a mechanism's freedoms, time left out: first of velocity, last of configuration.

    Nothing here reads a joint's own `holonomic`, so it checks `Mechanism.degrees_of_freedom`. With one freedom of
    velocity there is nothing to bracket: a car with its steering held can only follow one curve, and its skates are
    then integrable together, although `degrees_of_freedom` counts four configurations by the kinds of its joints.
    """
    dimensions = growth(mechanism_rows(mechanism), mechanism_place(mechanism, pose))
    return tuple(dimension - 1 for dimension in dimensions)
