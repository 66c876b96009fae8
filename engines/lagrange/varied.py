"""Many mechanisms of one shape from one of them and arrays of what differs: only the first is made as an object."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from engines.lagrange.batch import Stack, stacked
from engines.lagrange.differing import Differing, Part
from engines.lagrange.flat import (
    DEPENDENT,
    FORCE_NUMBERS,
    FORCE_PARAMETERS,
    GRAVITY,
    MOBILITY,
    PARAMETER_AT,
    PARAMETERS,
    POSE_UNIT,
    RATE,
    START_POSE,
    START_TWIST,
    TWIST_UNIT,
    Flat,
    force_parameters,
    parameters,
)
from reference.checks import InvalidMechanism, shown, validated
from reference.kinds import Floats, Rule, of_shape
from reference.mechanism import Mechanism

Array = NDArray[np.float64]
Triples = Annotated[Floats, of_shape("mechanisms", "bodies", 3)]
Masses = Annotated[Floats, of_shape("mechanisms", "bodies"), Rule(lambda value: np.all(value > 0), "greater than zero")]
Vectors = Annotated[Floats, of_shape("mechanisms", 2)]
AT_A_TIME = 4096  # mechanisms: their dense rows are in memory together


@validated
def varied(
    mechanism: Mechanism,
    pose: Triples | None = None,
    twist: Triples | None = None,
    mass: Masses | None = None,
    inertia: Masses | None = None,
    gravity: Vectors | None = None,
    joints: Any = None,
    forces: Any = None,
) -> Stack:
    """Mechanisms that are as this one but for the numbers given, one along the first axis of each array.

    pose, twist (mechanisms, bodies, 3) at t = 0 [m, m, rad], [m/s, m/s, rad/s]; mass, inertia (mechanisms, bodies) [kg,
    kg m^2]; gravity (mechanisms, 2) [m/s^2]. `joints` and `forces` have names of theirs, and for each name the numbers
    that differ: `{"B": {"first_point": points}}` with points (mechanisms, 2) [m]. It gives what `stacked` gives of the
    same mechanisms made one by one, in a thirtieth of the time.

    Raises InvalidMechanism for what is not there, for arrays of other lengths, and for a mechanism whose start does not
    satisfy its joints, by its number; Unsupported for rolls that are not round. A Roll is the same in all.
    """
    first = stacked((mechanism,))
    given = {"pose": pose, "twist": twist, "mass": mass, "inertia": inertia}
    own = {name: values for name, values in given.items() if values is not None}
    for name, values in own.items():
        if values.shape[1] != len(mechanism.bodies):
            raise InvalidMechanism(
                f"varied: {name} is of {values.shape[1]} bodies; the mechanism has {len(mechanism.bodies)}"
            )
    bodies = [
        Part(body, {name: values[:, index] for name, values in own.items()})
        for index, body in enumerate(mechanism.bodies)
    ]
    groups = bodies, _parts("joint", mechanism.joints, joints), _parts("force", mechanism.forces, forces)
    counts = {len(values) for group in groups for part in group for values in part.differing.values()}
    counts |= set() if gravity is None else {len(gravity)}
    if len(counts) != 1 or 0 in counts:
        told = " and ".join(map(str, sorted(counts))) or "no"
        raise InvalidMechanism(f"varied: the arrays are of {told} mechanisms; they must be of one number of them")
    (count,) = counts
    falls, poses, twists = (
        np.broadcast_to(np.asarray(usual), (count, *np.shape(usual))) if values is None else values
        for usual, values in ((mechanism.gravity, gravity), (mechanism.pose, pose), (mechanism.twist, twist))
    )
    differing = Differing(mechanism, *groups, falls, poses, twists)
    numbers = np.repeat(first.numbers, count, axis=0)
    for begin in range(0, count, AT_A_TIME):
        some = slice(begin, begin + AT_A_TIME)
        _fill(numbers[some], first.arrays, differing.some(some), begin)
    return replace(first, numbers=numbers)


def _parts(kind: str, usual: tuple[Any, ...], given: Any) -> list[Part]:
    """Joints or forces with the arrays that are given for them."""
    wanted = {} if given is None else given
    if not isinstance(wanted, Mapping) or not all(isinstance(numbers, Mapping) for numbers in wanted.values()):
        raise InvalidMechanism(
            f"varied: {kind}s is {shown(given)}; it must be names, and for each the numbers that differ"
        )
    names = [part.name for part in usual]
    for name in wanted:
        if name not in names:
            known = ", ".join(map(repr, names)) or "none"
            raise InvalidMechanism(f"varied: no {kind} is called {shown(name)}; there are {known}")
    return [Part.of(f"{kind} {part.name!r}", part, wanted.get(part.name, {})) for part in usual]


def _fill(numbers: Array, arrays: Flat, differing: Differing, begin: int) -> None:
    """Lay what differs over the first mechanism's numbers (mechanisms, n), in the places that `flat` gives them."""
    whole, count = arrays.whole, len(numbers)
    bodies = 3 * len(differing.bodies)

    def lay(place: int, values: Array) -> None:
        numbers[:, place : place + values.shape[1]] = values

    lay(whole[START_POSE], differing.pose.reshape(count, bodies))
    lay(whole[START_TWIST], differing.twist.reshape(count, bodies))
    lay(whole[GRAVITY], differing.gravity)
    for index, part in enumerate(differing.bodies):
        for name, columns in (("mass", (0, 1)), ("inertia", (2,))):
            for column in columns if name in part.differing else ():
                numbers[:, whole[MOBILITY] + 3 * index + column] = 1 / part.differing[name]
    for of, size, parts, begins in (
        (parameters, PARAMETERS, differing.joints, whole[PARAMETER_AT]),
        (force_parameters, FORCE_PARAMETERS, differing.forces, whole[FORCE_NUMBERS]),
    ):
        for index, part in enumerate(parts):
            for column, value in enumerate(of(part.together()) if part.differing else ()):
                numbers[:, begins + size * index + column] = value
    for row, rate in enumerate(differing.rates()):
        numbers[:, whole[RATE] + arrays.rows[row]] = rate
    lengths, times = differing.scales()
    unit = np.tile(np.stack([lengths, lengths, np.ones(count)], axis=1), len(differing.bodies) + 1)
    lay(whole[POSE_UNIT], unit)
    lay(whole[TWIST_UNIT], unit / times[:, None])
    differing.refuse_bad_starts(lengths, bool(whole[DEPENDENT]), begin)
