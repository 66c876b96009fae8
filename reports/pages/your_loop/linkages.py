"""Planar linkages as users of pymunk build them: in pixels, y up, mostly from rest; each function makes a new space.

A linkage is written as points by letter and links as words of these letters: "BPQ" is one body of three thin bars, and
a letter that two words share is a pivot. Those of bars alone are data, `linkages.toml`. LINKAGES has all by name.
"""

from __future__ import annotations

import itertools
import tomllib
from collections.abc import Callable, Mapping
from functools import cache, partial
from math import cos, hypot, inf, pi, sin, sqrt
from pathlib import Path
from typing import Any

import pymunk
from pymunk import Body, Space, Vec2d
from pymunk.constraints import (
    DampedSpring,
    GearJoint,
    GrooveJoint,
    PinJoint,
    PivotJoint,
    RotaryLimitJoint,
    SimpleMotor,
)

Points = Mapping[str, Vec2d]
DENSITY = 0.01  # mass of a bar per pixel
GRAVITY = (0, -900)


def new_space() -> Space:
    space = Space()
    space.gravity = GRAVITY
    return space


def points(**places: tuple[float, float]) -> dict[str, Vec2d]:
    return {letter: Vec2d(*place) for letter, place in places.items()}


def meet(p: Vec2d, from_p: float, q: Vec2d, from_q: float, side: int) -> Vec2d:
    """The point at these distances from p and q, left of the way from p to q (side 1) or right of it (-1)."""
    apart = q - p
    along = (from_p**2 - from_q**2 + apart.length**2) / (2 * apart.length)
    unit = apart.normalized()
    return p + unit * along + unit.perpendicular() * side * sqrt(from_p**2 - along**2)


def link(space: Space, *corners: Vec2d, density: float = DENSITY, group: int = 1) -> Body:
    """A body of thin bars between the corners, closed where there are three or more."""
    bars = list(itertools.pairwise(corners)) + ([(corners[-1], corners[0])] if len(corners) > 2 else [])
    masses = [density * (q - p).length for p, q in bars]
    centre = sum(((p + q) / 2 * mass for (p, q), mass in zip(bars, masses, strict=True)), Vec2d(0, 0)) / sum(masses)
    moment = sum(
        mass * ((q - p).length ** 2 / 12 + ((p + q) / 2 - centre).length ** 2)
        for (p, q), mass in zip(bars, masses, strict=True)
    )
    body = Body(sum(masses), moment)
    body.position = centre
    shapes = [pymunk.Segment(body, p - centre, q - centre, 3) for p, q in bars]
    for shape in shapes:
        shape.filter, shape.friction = pymunk.ShapeFilter(group=group), 1.0
    space.add(body, *shapes)
    return body


def pin(space: Space, a: Body, b: Body, at: Vec2d) -> None:
    space.add(PivotJoint(a, b, (at.x, at.y)))


def motor(space: Space, a: Body, b: Body, rate: float) -> None:
    """b turns at `rate` [rad/s] against a."""
    space.add(SimpleMotor(a, b, -rate))


def assemble(
    space: Space, where: Points, links: str, ground: str = "", base: Body | None = None, density: float = DENSITY
) -> dict[str, Body]:
    """The bodies by their words, pinned to each other, and to the base at the letters of `ground`."""
    base = space.static_body if base is None else base
    bodies = {word: link(space, *(where[letter] for letter in word), density=density) for word in links.split()}
    for letter in where:
        joined = [base] * (letter in ground) + [body for word, body in bodies.items() if letter in word]
        for other in joined[1:]:
            pin(space, joined[0], other, where[letter])
    return bodies


def _loose(space: Space, at: Vec2d, body: Body, shape: pymunk.Shape, group: int) -> Body:
    body.position = at
    shape.filter, shape.friction = pymunk.ShapeFilter(group=group), 1.0
    space.add(body, shape)
    return body


def ball(space: Space, at: Vec2d, mass: float, radius: float, group: int = 1) -> Body:
    body = Body(mass, pymunk.moment_for_circle(mass, 0, radius))
    return _loose(space, at, body, pymunk.Circle(body, radius), group)


def box(space: Space, at: Vec2d, mass: float, size: tuple[float, float], group: int = 1) -> Body:
    body = Body(mass, pymunk.moment_for_box(mass, size))
    return _loose(space, at, body, pymunk.Poly.create_box(body, size), group)


def floor(space: Space, height: float = 0.0) -> None:
    shape = pymunk.Segment(space.static_body, (-5000, height), (5000, height), 5)
    shape.friction = 1.0
    space.add(shape)


def slide(space: Space, base: Body, head: Body, along: Vec2d, reach: float) -> None:
    """The head's centre stays on a line of the base."""
    ends = [base.world_to_local(head.position + along * way) for way in (-reach, reach)]
    space.add(GrooveJoint(base, head, ends[0], ends[1], (0, 0)))


@cache
def _plans() -> dict[str, dict[str, Any]]:
    return tomllib.loads(Path(__file__).with_name("linkages.toml").read_text(encoding="utf-8"))


def planned(*names: str) -> dict[str, Callable[[], Space]]:
    """Linkages of `linkages.toml` by name."""
    return {name: partial(_from_plan, name) for name in names}


def _from_plan(name: str) -> Space:
    plan, space = _plans()[name], new_space()
    where = points(**plan["points"])
    bodies = assemble(space, where, plan["links"], plan["ground"], density=plan.get("density", DENSITY))
    bodies["ground"] = space.static_body
    for load in plan.get("loads", ()):
        at, mass = where[load["at"]], load["mass"]
        hung = ball(space, at, mass, load["ball"]) if "ball" in load else box(space, at, mass, tuple(load["box"]))
        pin(space, bodies[load["link"]], hung, at)
    if "motor" in plan:
        motor(space, space.static_body, bodies[plan["motor"]["link"]], plan["motor"]["rate"])
    if "gear" in plan:
        a, b = plan["gear"]["links"]
        space.add(GearJoint(bodies[a], bodies[b], 0.0, plan["gear"]["ratio"]))
    for spring in plan.get("springs", ()):
        (a, b), (at, other) = (bodies[word] for word in spring["links"]), spring["ends"]
        length = hypot(at[0] - other[0], at[1] - other[1])
        space.add(DampedSpring(a, b, a.world_to_local(at), b.world_to_local(other), length, 3000.0, 20))
    space.gravity = tuple(plan.get("gravity", GRAVITY))
    return space


def cylinder(space: Space, hip: Vec2d, crank: Body, knee: Vec2d, angle: float, rod: float) -> None:
    """A rod from the crank's pin to a head that slides along `angle` [rad] through the hip; the head can't turn."""
    along = Vec2d(cos(angle), sin(angle))
    apart = knee - hip
    across = apart.cross(along)
    at = hip + along * (apart.dot(along) + sqrt(rod**2 - across**2))
    pushed = link(space, knee, at)
    head = Body(2.0, inf)
    head.position = at
    space.add(head)
    pin(space, crank, pushed, knee)
    pin(space, pushed, head, at)
    slide(space, space.static_body, head, along, 150.0)


def engine(cylinders: int, rate: float) -> Space:
    """A steam engine, or a radial one: rods from one crank to heads in grooves."""
    space = new_space()
    hip, knee = Vec2d(0, 0), Vec2d(28, 28)
    crank = link(space, hip, knee)
    pin(space, space.static_body, crank, hip)
    for number in range(cylinders):
        cylinder(space, hip, crank, knee, 2 * pi * number / cylinders, 130.0)
    if rate:
        motor(space, space.static_body, crank, rate)
    return space


def jansen_points(angle: float, hip: Vec2d, side: int) -> dict[str, Vec2d]:
    """Theo Jansen's leg with his thirteen lengths, three pixels a unit."""
    a, b, c, d, e, f, g, h, i, j, k, below, m = (
        3 * length for length in (38, 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 65.7, 49, 50, 61.9, 7.8, 15)
    )
    knee = hip + Vec2d(cos(angle), sin(angle)) * m
    fixed = hip + Vec2d(-a * side, -below)
    top = meet(knee, j, fixed, b, -side)
    outer = meet(top, e, fixed, d, -side)
    low = meet(knee, k, fixed, c, side)
    ankle = meet(outer, f, low, g, side)
    return {
        "O": hip,
        "Z": knee,
        "B": fixed,
        "P": top,
        "Q": outer,
        "R": low,
        "T": ankle,
        "F": meet(ankle, h, low, i, side),
    }


def jansen_legs(space: Space, base: Body, hip: Vec2d, angle: float, rate: float, sides: tuple[int, ...]) -> float:
    """Legs on one crank with a motor on the base; the height of the lowest foot."""
    crank, feet = None, []
    for side in sides:
        where = jansen_points(angle, hip, side)
        if crank is None:
            crank = link(space, where["O"], where["Z"])
            pin(space, base, crank, hip)
            motor(space, base, crank, rate)
        bodies = assemble(space, where, "ZP ZR BPQ BR QT RTF", "B", base)
        # `assemble` has pinned the two rods at Z to each other; one of them goes on the crank.
        pin(space, crank, bodies["ZP"], where["Z"])
        feet.append(where["F"].y)
    return min(feet)


def jansen(sides: tuple[int, ...]) -> Space:
    space = new_space()
    jansen_legs(space, space.static_body, Vec2d(300, 300), 0.7, 4.0, sides)
    return space


def walker(pairs: int) -> Space:
    """A Strandbeest: pairs of Jansen's legs on a chassis, each with a motor, on the ground."""
    space = new_space()
    hip = Vec2d(300, 330)
    chassis = box(space, hip, 20, (240, 30))
    low = min(jansen_legs(space, chassis, hip, 0.7 + 2 * pi * pair / pairs, 3.0, (1, -1)) for pair in range(pairs))
    floor(space, low - 8.5)
    return space


def klann_points(angle: float, hip: Vec2d, side: int) -> dict[str, Vec2d]:
    """Joe Klann's leg: a crank, a bent arm, two rockers on the frame, and a bent leg."""
    upper, lower = hip + Vec2d(-70 * side, 185), hip + Vec2d(-177 * side, -53)
    knee = hip + Vec2d(cos(angle), sin(angle)) * 80
    elbow = meet(knee, 177, lower, 96, -side)
    end = elbow + (elbow - knee).rotated(-0.22 * side) * 0.88
    hinge = meet(end, 140, upper, 262, side)
    foot = end + (end - hinge).rotated(0.5 * side) * 1.9
    return {"O": hip, "Z": knee, "D": elbow, "E": end, "B": lower, "A": upper, "H": hinge, "F": foot}


def klann_leg(space: Space, base: Body, hip: Vec2d, angle: float, rate: float, side: int) -> float:
    where = klann_points(angle, hip, side)
    bodies = assemble(space, where, "OZ ZDE BD AH HEF", "OBA", base)
    motor(space, base, bodies["OZ"], rate)
    return where["F"].y


def klann() -> Space:
    space = new_space()
    klann_leg(space, space.static_body, Vec2d(0, 0), 0.7, 4.0, 1)
    return space


def klann_walker() -> Space:
    space = new_space()
    hip = Vec2d(0, 0)
    chassis = box(space, hip, 20, (240, 30))
    phases = [(0.7, 1), (0.7 + pi, 1), (0.7, -1), (0.7 + pi, -1)]
    floor(space, min(klann_leg(space, chassis, hip, angle, 3.0, side) for angle, side in phases) - 8.5)
    return space


def chebyshev_walker() -> Space:
    """Chebyshev's lambda leg, four of them in two pairs on a chassis on the ground."""
    space = new_space()
    hip = Vec2d(0, 0)
    chassis = box(space, hip + Vec2d(0, 40), 10, (160, 30))
    low = inf
    for angle, side in ((pi / 2, 1), (-pi / 2, 1), (pi / 2, -1), (-pi / 2, -1)):
        fixed = hip + Vec2d(-80 * side, 0)
        knee = hip + Vec2d(cos(angle), sin(angle)) * 40
        elbow = meet(knee, 100, fixed, 100, -side)
        where = {"O": hip, "Z": knee, "B": fixed, "E": elbow, "F": elbow + (elbow - knee)}
        bodies = assemble(space, where, "OZ ZEF BE", "OB", chassis)
        motor(space, chassis, bodies["OZ"], 4.0)
        low = min(low, where["F"].y, hip.y - 40)
    floor(space, low - 12)
    return space


def ragdoll(contact: bool) -> Space:
    """Ten parts with pivots and limits of the angles; held by a hand, or dropped on the ground."""
    space = new_space()
    group = 1
    torso, head = box(space, Vec2d(0, 150), 10, (30, 60), group), ball(space, Vec2d(0, 195), 3, 14, group)
    joints = [(torso, head, Vec2d(0, 181), 0.5)]
    for side in (-1, 1):
        upper, lower = (box(space, Vec2d(side * x, 170), mass, (36, 9), group) for x, mass in ((34, 2), (70, 1)))
        joints += [(torso, upper, Vec2d(side * 16, 170), 1.5), (upper, lower, Vec2d(side * 52, 170), 1.2)]
        thigh, shin = (box(space, Vec2d(side * 9, y), mass, (12, 45), group) for y, mass in ((98, 4), (53, 3)))
        joints += [(torso, thigh, Vec2d(side * 9, 120), 0.8), (thigh, shin, Vec2d(side * 9, 75), 1.0)]
        if side == 1 and not contact:
            pin(space, space.static_body, lower, Vec2d(88, 170))
    for a, b, at, limit in joints:
        pin(space, a, b, at)
        space.add(RotaryLimitJoint(a, b, -limit, limit))
    if contact:
        floor(space, -60)
    return space


def row_of_bars(space: Space, start: Vec2d, way: Vec2d, count: int, density: float = DENSITY) -> list[Body]:
    """Equal bars one after the other, the first on the ground."""
    bars = [link(space, start + way * number, start + way * (number + 1), density=density) for number in range(count)]
    for number, (a, b) in enumerate(zip([space.static_body, *bars], bars, strict=False)):
        pin(space, a, b, start + way * number)
    return bars


def chain(count: int, ball_mass: float = 0.0) -> Space:
    """A rope, or a wrecking ball on it, let go from the side."""
    space = new_space()
    bars = row_of_bars(space, Vec2d(0, 300), Vec2d(20, 0), count)
    if ball_mass:
        at = Vec2d(20 * count, 300)
        pin(space, bars[-1], ball(space, at, ball_mass, 15), at)
    return space


def bridge() -> Space:
    """A rope bridge between two banks, and a barrel that drops on it."""
    space = new_space()
    bars = row_of_bars(space, Vec2d(0, 100), Vec2d(20, 0), 16, density=0.05)
    pin(space, bars[-1], space.static_body, Vec2d(320, 100))
    ball(space, Vec2d(150, 160), 3.0, 15, group=2)
    return space


def car(suspended: bool) -> Space:
    """A chassis on two wheels with a motor on the ground; pivots, or grooves and springs."""
    space = new_space()
    body = box(space, Vec2d(0, 60), 10, (120, 20))
    floor(space, 0)
    bump = pymunk.Segment(space.static_body, (250, 5), (330, 25), 5)
    bump.friction = 1.0
    space.add(bump)
    for x in (-45, 45):
        wheel = ball(space, Vec2d(x, 25), 2, 20)
        if suspended:
            space.add(GrooveJoint(body, wheel, (x, -15), (x, -50), (0, 0)))
            space.add(DampedSpring(body, wheel, (x, 0), (0, 0), 50, 4000, 100))
        else:
            pin(space, body, wheel, wheel.position)
        motor(space, body, wheel, -10.0)
    return space


def tow_truck() -> Space:
    """A car that pulls a trailer by a PinJoint."""
    space = car(suspended=False)
    truck = next(iter(space.bodies))
    trailer = box(space, Vec2d(-200, 50), 5, (100, 20))
    wheel = ball(space, Vec2d(-200, 25), 1, 20)
    pin(space, trailer, wheel, wheel.position)
    space.add(PinJoint(truck, trailer, (-60, -10), (50, 0)))
    return space


def crane() -> Space:
    """A luffing crane: a jib that a stay of bars holds, and a heavy load on a rope."""
    space = new_space()
    where = points(A=(0, 0), B=(0, 120), C=(180, 130), D=(90, 160))
    bodies = assemble(space, where, "AC BD DC", "AB", density=0.05)
    bars = row_of_bars(space, where["C"], Vec2d(6, -14), 6)
    space.remove(*[joint for joint in bars[0].constraints if joint.a is space.static_body])
    pin(space, bodies["AC"], bars[0], where["C"])
    load = where["C"] + Vec2d(6, -14) * 6
    pin(space, bars[-1], ball(space, load, 8.0, 12), load)
    return space


def cable_crane() -> Space:
    """A boom that a motor turns, and a load on a PinJoint."""
    space = new_space()
    boom = link(space, Vec2d(0, 0), Vec2d(150, 120), Vec2d(140, 140), density=0.05)
    pin(space, space.static_body, boom, Vec2d(0, 0))
    motor(space, space.static_body, boom, 0.5)
    load = ball(space, Vec2d(150, 20), 10.0, 15)
    space.add(PinJoint(boom, load, boom.world_to_local((150, 120)), (0, 0)))
    return space


def scissor_lift(stages: int) -> Space:
    """Crossed bars above each other; one foot slides, and the whole sinks under a platform."""
    space = new_space()
    width, height = 120.0, 60.0
    feet = [space.static_body, ball(space, Vec2d(width, 0), 1.0, 5)]
    slide(space, space.static_body, feet[1], Vec2d(1, 0), 300.0)
    for stage in range(stages):
        y = stage * height
        left, right = Vec2d(0, y), Vec2d(width, y)
        rising = link(space, left, Vec2d(width, y + height))
        falling = link(space, right, Vec2d(0, y + height))
        pin(space, feet[0], rising, left)
        pin(space, feet[1], falling, right)
        pin(space, rising, falling, Vec2d(width / 2, y + height / 2))
        feet = [falling, rising]
    platform = box(space, Vec2d(width / 2, stages * height + 8), 2.0, (width, 10))
    pin(space, feet[0], platform, Vec2d(0, stages * height))
    space.add(GrooveJoint(platform, feet[1], (-60, -8), (200, -8), feet[1].world_to_local((width, stages * height))))
    return space


def peaucellier() -> Space:
    """Seven bars that draw a straight line."""
    space = new_space()
    a, b = 130.0, 80.0
    near = Vec2d(40 + 40 * cos(0.6), 40 * sin(0.6))
    turned = near.angle
    # The rhombus: its far corner is at (a^2 - b^2) / |near| on the same ray.
    far = near * ((a**2 - b**2) / near.length**2)
    middle, half = (near + far) / 2, sqrt(b**2 - ((far - near).length / 2) ** 2)
    normal = Vec2d(-sin(turned), cos(turned)) * half
    where = {"A": Vec2d(0, 0), "M": Vec2d(40, 0), "N": near, "P": far, "U": middle + normal, "L": middle - normal}
    assemble(space, where, "MN AU AL NU NL UP LP", "AM")
    return space


def pumpjack() -> Space:
    """A motor, a beam with a heavy head, and a rod in a groove."""
    space = new_space()
    where = points(A=(0, 0), B=(-20, 30), C=(-30, 150), D=(80, 150), E=(200, 150))
    bodies = assemble(space, where, "AB BC CDE", "AD", density=0.05)
    motor(space, space.static_body, bodies["AB"], 2.0)
    rod = Body(15.0, inf)
    rod.position = 200, 70
    space.add(rod)
    hanger = link(space, where["E"], rod.position)
    pin(space, bodies["CDE"], hanger, where["E"])
    pin(space, hanger, rod, rod.position)
    slide(space, space.static_body, rod, Vec2d(0, 1), 200.0)
    return space


def welded_beam() -> Space:
    """A cantilever of boxes that pivots and gears weld, with a weight at its end."""
    space = new_space()
    before = space.static_body
    for number in range(5):
        part = box(space, Vec2d(30 * number + 15, 0), 1.0, (30, 10))
        pin(space, before, part, Vec2d(30 * number, 0))
        space.add(GearJoint(before, part, 0.0, 1.0))
        before = part
    return space


def tank_track() -> Space:
    """Twelve links in a closed loop around two wheels, let go on the ground."""
    space = new_space()
    count, radius = 12, 60.0
    ring = [Vec2d(cos(2 * pi * n / count), sin(2 * pi * n / count)) * radius for n in range(count)]
    bars = [link(space, ring[n], ring[(n + 1) % count], group=2) for n in range(count)]
    for n in range(count):
        pin(space, bars[n - 1], bars[n], ring[n])
    floor(space, -75)
    return space


def cyclist() -> Space:
    """Two legs on pedals: four-bars that share a crank, with a motor."""
    space = new_space()
    crank = link(space, Vec2d(0, 20), Vec2d(0, -20))
    pin(space, space.static_body, crank, Vec2d(0, 0))
    hip = Vec2d(-30, 115)
    for pedal in (Vec2d(0, 20), Vec2d(0, -20)):
        knee = meet(pedal, 70, hip, 75, -1)
        bodies = assemble(space, {"P": pedal, "K": knee, "H": hip}, "PK KH", "H", density=0.04)
        pin(space, crank, bodies["PK"], pedal)
    motor(space, space.static_body, crank, -5.0)
    return space


def folding_chair() -> Space:
    """Two crossed legs and a seat in a groove, which collapse."""
    space = new_space()
    where = points(A=(0, 0), X=(50, 45), B=(100, 90), D=(0, 90))
    foot = ball(space, Vec2d(100, 0), 0.5, 4)
    slide(space, space.static_body, foot, Vec2d(1, 0), 200.0)
    bodies = assemble(space, where, "AXB", "A", density=0.03)
    other = link(space, Vec2d(100, 0), where["D"], density=0.03)
    pin(space, bodies["AXB"], other, where["X"])
    pin(space, foot, other, Vec2d(100, 0))
    seat = box(space, Vec2d(50, 90), 3.0, (100, 8))
    pin(space, other, seat, where["D"])
    space.add(GrooveJoint(seat, bodies["AXB"], (-40, 0), (150, 0), bodies["AXB"].world_to_local((100, 90))))
    return space


LINKAGES: Mapping[str, Callable[[], Space]] = {
    **planned(
        "four-bar",
        "four-bar with a motor",
        "pair of wipers (parallelogram)",
        "six-bar of Watt",
        "six-bar of Stephenson with a motor",
    ),
    "piston in a groove": lambda: engine(1, 0.0),
    "piston in a groove with a motor": lambda: engine(1, 8.0),
    "radial engine of three pistons": lambda: engine(3, 8.0),
    "Jansen's leg with a motor": lambda: jansen((1,)),
    "two legs of Jansen on a crank": lambda: jansen((1, -1)),
    "Strandbeest of two legs on the ground": lambda: walker(1),
    "Strandbeest of six legs on the ground": lambda: walker(3),
    "Klann's leg with a motor": klann,
    "walker of four legs of Klann": klann_walker,
    "walker of four legs of Chebyshev": chebyshev_walker,
    "ragdoll that hangs by a hand": lambda: ragdoll(contact=False),
    "ragdoll that falls": lambda: ragdoll(contact=True),
    "rope of twenty links": lambda: chain(20),
    "wrecking ball, fifty times a link": lambda: chain(8, 10.0),
    "rope bridge with a barrel": bridge,
    "car with a motor": lambda: car(suspended=False),
    "car on grooves and springs": lambda: car(suspended=True),
    "car with a trailer": tow_truck,
    "crane with a load on a rope": crane,
    "crane with a load on a PinJoint": cable_crane,
    **planned("excavator", "trebuchet"),
    "scissor lift of one stage": lambda: scissor_lift(1),
    "scissor lift of three stages": lambda: scissor_lift(3),
    **planned("pantograph"),
    "Peaucellier's linkage": peaucellier,
    "pumpjack": pumpjack,
    **planned("geared five-bar"),
    "beam of welds": welded_beam,
    **planned("mobile"),
    "tank track on the ground": tank_track,
    "cyclist": cyclist,
    "folding chair": folding_chair,
    **planned("swing on two ropes"),
}
