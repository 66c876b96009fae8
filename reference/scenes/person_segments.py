"""Segments of a human body as fractions of its mass and height: D. A. Winter's table.

Biomechanics and Motor Control of Human Movement, 4th edition, Wiley 2009: masses, centres and radii of gyration from
table 4.1 (after Dempster 1955), lengths from figure 4.1 (after Drillis and Contini 1966). The trunk is Winter's HAT:
head, arms and trunk, between hip and shoulder.
"""

from __future__ import annotations

from dataclasses import dataclass

from reference.checks import Fraction, Valid


@dataclass(frozen=True)
class Segment(Valid):
    """Fractions: of the body's mass; of its height, the length; of the length, centre from the upper end, and gyration.

    `centre` is measured from the upper joint (for the trunk, whose joint is the hip, from the hip up); `gyration` is
    the radius of gyration about the centre of mass.
    """

    mass: Fraction
    length: Fraction
    centre: Fraction
    gyration: Fraction


# Winter, table 4.1 (mass, centre from the proximal end, radius of gyration about it) and figure 4.1 (length).
HEAD_ARMS_TRUNK = Segment(0.678, 0.288, 0.626, 0.496)
THIGH = Segment(0.100, 0.245, 0.433, 0.323)
SHANK = Segment(0.0465, 0.246, 0.433, 0.302)
SHANK_AND_FOOT = Segment(0.061, 0.246, 0.606, 0.416)
