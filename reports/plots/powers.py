"""Labels of logarithmic axes as powers of ten."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatterSciNotation

TIMES_SIGN = "\N{MULTIPLICATION SIGN}"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class PowersOfTen(LogFormatterSciNotation):
    """Labels of a logarithmic axis as texts such as 10⁻³, since matplotlib parses formulas slowly."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        if not super().__call__(x, pos):  # a minor tick without a label
            return ""
        digits, power = f"{x:.0e}".split("e")
        return f"{'' if digits == '1' else digits + TIMES_SIGN}10{str(int(power)).translate(SUPERSCRIPTS)}"


def label_in_powers(figure: Figure) -> None:
    """Replace matplotlib's own labels of all logarithmic axes of a figure."""
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) if axis.get_scale() == "log"):
        if type(axis.get_major_formatter()) is LogFormatterSciNotation:
            axis.set_major_formatter(PowersOfTen())
        if type(axis.get_minor_formatter()) is LogFormatterSciNotation:
            axis.set_minor_formatter(PowersOfTen(labelOnlyBase=False))
