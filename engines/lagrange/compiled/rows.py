"""Gaps, velocity rows J and bias terms -(dJ/dt) v of every joint, as in `reference.joints`, and applied forces.

The bias is written out for each joint: what the derivative of n . (v_second - v_first) leaves when accelerations are
taken away, with the normal n of a line, its direction t and its points.
"""

from __future__ import annotations

import math

from engines.lagrange import arrays as ix
from engines.lagrange.compiled.inner import inner


@inner
def rows(whole, real, cells, pose, twist, t):
    """Fill ends, gaps and biases at the pose and the twist that stand at these places; no gap where nothing is held."""
    turned, all_ends, gaps, biases = whole[ix.TURNED], whole[ix.ENDS], whole[ix.GAP], whole[ix.BIAS]
    for body in range(0, whole[ix.COLUMNS] - 3, 3):
        angle = real[pose + body + 2]
        real[turned + 2 * (body // 3)] = math.cos(angle)
        real[turned + 2 * (body // 3) + 1] = math.sin(angle)
    for joint in range(whole[ix.JOINTS]):
        record, number = whole[ix.JOINT_AT] + ix.JOINT * joint, whole[ix.PARAMETER_AT] + ix.PARAMETERS * joint
        kind, first, second, row = whole[record], whole[record + 1], whole[record + 2], whole[record + 3]
        if kind == ix.COUPLING:
            continue  # see `coupled_rows`
        e, gap, bias = all_ends + 6 * row, gaps + row, biases + row
        omega, spin = real[twist + first + 2], real[twist + second + 2]
        if kind in (ix.DRIVE, ix.GEAR):
            ratio = real[number + 5] if kind == ix.GEAR else 1.0
            aim = real[number + 6] + real[number + 5] * t if kind == ix.DRIVE else real[number + 6]
            real[e + 2], real[e + 5] = -ratio, 1.0
            real[gap] = real[pose + second + 2] - ratio * real[pose + first + 2] - aim
            real[bias] = 0.0
            continue
        if kind == ix.ROLL:
            roll_rows(whole, real, cells, record, pose, twist)
            continue
        c, d = real[turned + 2 * (first // 3)], real[turned + 2 * (first // 3) + 1]
        g, h = real[turned + 2 * (second // 3)], real[turned + 2 * (second // 3) + 1]
        ax, ay = c * real[number] - d * real[number + 1], d * real[number] + c * real[number + 1]
        bx, by = g * real[number + 2] - h * real[number + 3], h * real[number + 2] + g * real[number + 3]
        arm_x = real[pose + second] + bx - real[pose + first]
        arm_y = real[pose + second + 1] + by - real[pose + first + 1]
        if kind in (ix.PIN, ix.WELD):
            real[e], real[e + 2], real[e + 3], real[e + 5] = -1.0, ay, 1.0, -by
            real[e + 7], real[e + 8], real[e + 10], real[e + 11] = -1.0, -ax, 1.0, bx
            real[gap], real[gap + 1] = arm_x - ax, arm_y - ay
            real[bias] = spin * spin * bx - omega * omega * ax
            real[bias + 1] = spin * spin * by - omega * omega * ay
            if kind == ix.WELD:
                real[e + 14], real[e + 17] = -1.0, 1.0
                real[gap + 2] = real[pose + second + 2] - real[pose + first + 2] - real[number + 4]
                real[bias + 2] = 0.0
            continue
        if kind == ix.ROD:
            x, y = arm_x - ax, arm_y - ay
            length = math.sqrt(x * x + y * y)
            x, y = x / length, y / length
            fast_x = real[twist + second] - spin * by - real[twist + first] + omega * ay
            fast_y = real[twist + second + 1] + spin * bx - real[twist + first + 1] - omega * ax
            across = x * fast_y - y * fast_x
            real[e], real[e + 1], real[e + 2] = -x, -y, x * ay - y * ax
            real[e + 3], real[e + 4], real[e + 5] = x, y, y * bx - x * by
            real[gap] = length - real[number + 4]
            inward = spin * spin * (x * bx + y * by) - omega * omega * (x * ax + y * ay)
            real[bias] = inward - across * across / length
            continue
        line_row(whole, real, record, number, pose, twist, ax, ay, bx, by)
    if whole[ix.SUMMANDS] > 0:
        coupled_rows(whole, real, pose, twist)


@inner
def line_row(whole, real, record, number, pose, twist, ax, ay, bx, by):
    """The row of a slot or a blade, from the arms a and b to its points on both bodies."""
    kind, first, second, row = whole[record], whole[record + 1], whole[record + 2], whole[record + 3]
    e, gap, bias = whole[ix.ENDS] + 6 * row, whole[ix.GAP] + row, whole[ix.BIAS] + row
    omega, spin = real[twist + first + 2], real[twist + second + 2]
    arm_x = real[pose + second] + bx - real[pose + first]
    arm_y = real[pose + second + 1] + by - real[pose + first + 1]
    # A slot's line turns with the first body, a blade with the second: its direction (x, y), its normal (-y, x).
    angle = real[number + 4] + (real[pose + first + 2] if kind == ix.SLOT else real[pose + second + 2])
    x, y = math.cos(angle), math.sin(angle)
    fast_x = real[twist + second] - spin * by - real[twist + first]
    fast_y = real[twist + second + 1] + spin * bx - real[twist + first + 1]
    real[e], real[e + 1], real[e + 2] = y, -x, -x * arm_x - y * arm_y
    real[e + 3], real[e + 4], real[e + 5] = -y, x, y * by + x * bx
    along = x * fast_x + y * fast_y
    over_material = x * (fast_x + omega * arm_y) + y * (fast_y - omega * arm_x)
    inward = spin * spin * (x * by - y * bx)
    if kind == ix.SLOT:
        real[gap] = x * (arm_y - ay) - y * (arm_x - ax)
        real[bias] = inward + omega * (along + over_material)
    else:
        real[gap] = 0.0
        real[bias] = inward + omega * along + spin * over_material


@inner
def coupled_rows(whole, real, pose, twist):
    """The rows of couplings: sums, whose ends are first emptied."""
    records, ends = whole[ix.SUMMAND_AT], whole[ix.ENDS]
    last = records + ix.SUMMAND * whole[ix.SUMMANDS]
    for record in range(records, last, ix.SUMMAND):
        real[whole[ix.GAP] + whole[record]] = real[whole[ix.BIAS] + whole[record]] = 0.0
        for k in range(3):
            real[ends + whole[record + 3] + k] = real[ends + whole[record + 4] + k] = 0.0
    number = whole[ix.SUMMAND_NUMBERS]
    for record in range(records, last, ix.SUMMAND):
        row, first, second = whole[record], whole[record + 1], whole[record + 2]
        value, x, y, turn, other = summand(whole, real, record, number, pose)
        e, f = ends + whole[record + 3], ends + whole[record + 4]
        real[e] -= x
        real[e + 1] -= y
        real[e + 2] += turn
        real[f] += x
        real[f + 1] += y
        real[f + 2] += other
        real[whole[ix.GAP] + row] += value - real[number + 6]
        if whole[record + 5] != 0:
            omega, spin = real[twist + first + 2], real[twist + second + 2]
            g, h = math.cos(real[pose + second + 2]), math.sin(real[pose + second + 2])
            bx, by = g * real[number + 3] - h * real[number + 4], h * real[number + 3] + g * real[number + 4]
            arm_x = real[pose + second] + bx - real[pose + first]
            arm_y = real[pose + second + 1] + by - real[pose + first + 1]
            fast_x = real[twist + second] - spin * by - real[twist + first]
            fast_y = real[twist + second + 1] + spin * bx - real[twist + first + 1]
            bias = spin * spin * (x * bx + y * by) + omega * omega * (x * arm_x + y * arm_y)
            real[whole[ix.BIAS] + row] += bias - 2 * omega * (x * fast_y - y * fast_x)
        number += ix.SUMMAND_PARAMETERS


@inner
def summand(whole, real, record, number, pose):
    """A term of a sum as in `reference.couplings`: its value; its derivatives by the place of the second body, which
    are opposite by that of the first; and by the angles of the first and of the second body.
    """
    first, second, factor = whole[record + 1], whole[record + 2], real[number]
    if whole[record + 5] == 0:
        return factor * (real[pose + second + 2] - real[pose + first + 2]), 0.0, 0.0, -factor, factor
    turned, angle = real[pose + first + 2], real[pose + second + 2]
    line = turned + real[number + 5]
    x, y = factor * math.cos(line), factor * math.sin(line)
    c, d, g, h = math.cos(turned), math.sin(turned), math.cos(angle), math.sin(angle)
    ax, ay = c * real[number + 1] - d * real[number + 2], d * real[number + 1] + c * real[number + 2]
    bx, by = g * real[number + 3] - h * real[number + 4], h * real[number + 3] + g * real[number + 4]
    arm_x = real[pose + second] + bx - real[pose + first]
    arm_y = real[pose + second + 1] + by - real[pose + first + 1]
    value = x * (arm_x - ax) + y * (arm_y - ay)
    return value, x, y, x * arm_y - y * arm_x, y * bx - x * by


@inner
def coupled_force(whole, real, number, begin, count, pose, twist, out):
    """Add what a coupled force does: its strength follows from the whole sum and its rate."""
    strength, at = (
        real[number] + real[number + 1] * real[number + 3],
        whole[ix.SUMMAND_NUMBERS] + ix.SUMMAND_PARAMETERS * begin,
    )
    record = whole[ix.SUMMAND_AT] + ix.SUMMAND * begin
    for k in range(count):
        first, second = whole[record + ix.SUMMAND * k + 1], whole[record + ix.SUMMAND * k + 2]
        value, x, y, turn, other = summand(whole, real, record + ix.SUMMAND * k, at + ix.SUMMAND_PARAMETERS * k, pose)
        rate = x * (real[twist + second] - real[twist + first]) + y * (
            real[twist + second + 1] - real[twist + first + 1]
        )
        rate += turn * real[twist + first + 2] + other * real[twist + second + 2]
        strength -= real[number + 1] * value + real[number + 2] * rate
    for k in range(count):
        first, second = whole[record + ix.SUMMAND * k + 1], whole[record + ix.SUMMAND * k + 2]
        value, x, y, turn, other = summand(whole, real, record + ix.SUMMAND * k, at + ix.SUMMAND_PARAMETERS * k, pose)
        push(whole, real, out, first, -x * strength, -y * strength, turn * strength)
        push(whole, real, out, second, x * strength, y * strength, other * strength)


@inner
def roll_rows(whole, real, cells, record, pose, twist):
    """The rows of a Roll, along e_t and then e_n = -i e_t; vectors are complex numbers, as in `rolling_table`.

    With P(theta) the place of the second body in the frame R of the first, the pair is closed by r2 - r1 = R P.
    """
    first, second, row, which = whole[record + 1], whole[record + 2], whole[record + 3], whole[record + 4]
    omega, spin = real[twist + first + 2], real[twist + second + 2]
    theta = real[pose + second + 2] - real[pose + first + 2]
    place, once, twice, tangent, turning = contact(whole, real, cells, which, theta)
    angle = real[pose + first + 2]
    frame = complex(math.cos(angle), math.sin(angle))
    place, once, twice, tangent = frame * place, frame * once, frame * twice, frame * tangent
    relative = spin - omega
    x, y = real[pose + second] - real[pose + first], real[pose + second + 1] - real[pose + first + 1]
    apart = complex(x, y) - place
    x, y = real[twist + second] - real[twist + first], real[twist + second + 1] - real[twist + first + 1]
    slip = complex(x, y) - 1j * omega * place - relative * once
    forced = -omega * omega * place + 2j * omega * relative * once + relative * relative * twice
    forced += 1j * (omega + relative * turning) * slip  # e_t turns too
    at_first = once - 1j * place
    for k in range(2):
        e, gap, bias = whole[ix.ENDS] + 6 * (row + k), whole[ix.GAP] + row + k, whole[ix.BIAS] + row + k
        x, y = tangent.real, tangent.imag
        real[e], real[e + 1], real[e + 2] = -x, -y, x * at_first.real + y * at_first.imag
        real[e + 3], real[e + 4], real[e + 5] = x, y, -x * once.real - y * once.imag
        real[gap] = x * apart.real + y * apart.imag
        real[bias] = x * forced.real + y * forced.imag
        tangent = -1j * tangent


@inner
def rotation(whole, real, which, pose):
    """The angle of a roll's second body against the first in a pose."""
    for joint in range(whole[ix.JOINTS]):
        record = whole[ix.JOINT_AT] + ix.JOINT * joint
        if whole[record] == ix.ROLL and whole[record + 4] == which:
            return real[pose + whole[record + 2] + 2] - real[pose + whole[record + 1] + 2]
    return math.nan


@inner
def contact(whole, real, cells, which, theta):
    """P, P', P'', the tangent e_t and its turning in a radian, in the first body's frame; NaN without a cell.

    The constants of closed forms are told in `rolling_table`; in a table P'' is s' e_n - a, and the arm a is -i P'.
    """
    record, c = whole[ix.ROLL_AT] + ix.ROLL_RECORD * which, whole[ix.ROLL_NUMBERS] + 2 * ix.CONSTANTS * which
    turn = complex(math.cos(theta), math.sin(theta))
    if whole[record] == ix.ON_LINE:
        along, out = complex(real[c + 2], real[c + 3]), turn * complex(real[c + 4], real[c + 5])
        place = complex(real[c], real[c + 1]) + along * (theta - real[c + 6]) - out
        return place, along - 1j * out, out, along * (1 / abs(along)), 0.0
    if whole[record] == ix.ON_ROUND:
        turning = real[c + 12]
        angle = real[c + 10] + turning * (theta - real[c + 8])
        tangent = complex(math.cos(angle), math.sin(angle))
        radius, out = complex(real[c + 4], real[c + 5]) * tangent, turn * complex(real[c + 6], real[c + 7])
        place = complex(real[c], real[c + 1]) + complex(real[c + 2], real[c + 3]) * tangent - out
        return place, 1j * (radius - out), out - turning * radius, tangent, turning
    position = theta / real[c]
    index = math.floor(position) - whole[record + 1] if abs(position) < 1e15 else -1
    if index < 0 or index >= whole[record + 2] or math.isnan(cells[whole[record + 3] + index, 0].real):
        if not math.isnan(theta):
            real[whole[ix.STATUS] + ix.WANTED_ROLL], real[whole[ix.STATUS] + ix.WANTED_ANGLE] = which, theta
        lost = complex(math.nan, math.nan)
        return lost, lost, lost, lost, math.nan
    c = whole[record + 3] + index
    u = theta - cells[c, 0].real
    place = once = twice = thrice = 0j
    for k in range(19, 13, -1):
        place = place * u + cells[c, k]
    for k in range(13, 8, -1):
        once = once * u + cells[c, k]
    for k in range(8, 2, -1):
        twice = twice * u + cells[c, k]
    for k in range(8, 3, -1):
        thrice = thrice * u + (k - 3) * cells[c, k]
    place, once = (place * u + cells[c, 2]) * u + cells[c, 1], (once * u + cells[c, 3]) * u + cells[c, 2]
    normal = twice - 1j * once
    length = abs(normal)
    turning = (normal.conjugate() * (thrice - 1j * twice)).imag / (length * length)
    return place, once, twice, normal * (1j / length), turning


@inner
def applied_accelerations(whole, real, pose, twist, out):
    """Accelerations of all forces but those of joints, to `out`."""
    for body in range(out, out + whole[ix.COLUMNS] - 3, 3):
        real[body], real[body + 1], real[body + 2] = real[whole[ix.GRAVITY]], real[whole[ix.GRAVITY] + 1], 0.0
    for force in range(whole[ix.FORCES]):
        record, number = whole[ix.FORCE_AT] + ix.FORCED * force, whole[ix.FORCE_NUMBERS] + ix.FORCE_PARAMETERS * force
        kind, first, second = whole[record], whole[record + 1], whole[record + 2]
        if kind == ix.COUPLED:
            coupled_force(whole, real, number, first, second, pose, twist, out)
            continue
        size, other = real[number + 4], real[number + 5]
        if kind in (ix.SPRING, ix.DAMPER, ix.FORCE):
            angle = real[pose + first + 2]
            c, d = math.cos(angle), math.sin(angle)
            angle = real[pose + second + 2]
            g, h = math.cos(angle), math.sin(angle)
            ax, ay = c * real[number] - d * real[number + 1], d * real[number] + c * real[number + 1]
            bx, by = g * real[number + 2] - h * real[number + 3], h * real[number + 2] + g * real[number + 3]
            if kind == ix.FORCE:
                push(whole, real, out, second, size, other, bx * other - by * size)
                continue
            x = real[pose + second] + bx - real[pose + first] - ax
            y = real[pose + second + 1] + by - real[pose + first + 1] - ay
            if kind == ix.SPRING:
                pull = size
                if other != 0:
                    pull -= size * other / math.sqrt(x * x + y * y)
            else:
                fast_x = real[twist + second] - real[twist + second + 2] * by
                fast_x -= real[twist + first] - real[twist + first + 2] * ay
                fast_y = real[twist + second + 1] + real[twist + second + 2] * bx
                fast_y -= real[twist + first + 1] + real[twist + first + 2] * ax
                pull = size * (x * fast_x + y * fast_y) / (x * x + y * y)
            x, y = -pull * x, -pull * y
            push(whole, real, out, second, x, y, bx * y - by * x)
            push(whole, real, out, first, -x, -y, ay * x - ax * y)
            continue
        if kind == ix.TORQUE:
            torque = size
        elif kind == ix.TORSION_SPRING:
            torque = -size * (real[pose + second + 2] - real[pose + first + 2] - other)
        else:
            torque = -size * (real[twist + second + 2] - real[twist + first + 2])
        push(whole, real, out, second, 0.0, 0.0, torque)
        push(whole, real, out, first, 0.0, 0.0, -torque)


@inner
def push(whole, real, out, body, x, y, torque):
    """What a force and a torque at the centre of mass add to a body's accelerations; the ground has no mobility."""
    mobility = whole[ix.MOBILITY] + body
    real[out + body] += real[mobility] * x
    real[out + body + 1] += real[mobility + 1] * y
    real[out + body + 2] += real[mobility + 2] * torque
