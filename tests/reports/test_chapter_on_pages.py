"""What the chapter states and asks stands on the page of its subject, with numbers that the page computes."""

from __future__ import annotations

import cmath
import itertools
import math
import re

import pytest
from scipy.optimize import brentq

from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.model.page import Material, Page
from reports.pages.errata.page import PAGE as ERRATA
from reports.pages.four_bar.page import PAGE as FOUR_BAR
from reports.pages.pendulum.page import PAGE as PENDULUM
from reports.pages.rendering import render_page
from reports.pages.skate.page import PAGE as SKATE
from reports.write.templates import anchor, headings


def text_of(page: Page) -> str:
    return render_page(page, Material({}), "made")[f"{page.name}.md"]


def test_the_two_problems_have_their_answers_and_the_derivative_agrees():
    text = text_of(PENDULUM)
    lines = re.findall(r"\| (18\.5\.[12]) ([abc]) \| \((\S+), (\S+)\) m/s²? \| (\S+) \|", text)
    assert [(problem, part) for problem, part, *_ in lines] == [(f"18.5.{n}", part) for n in (1, 2) for part in "abc"]
    assert all(float(miss) < 1e-14 for *_, miss in lines)
    # By hand: l = 0.7 m, phi = (0.4, -1.1), rates (2, 3), and for 18.5.2 (-5, 0.6) rad/s^2.
    by_hand = 0.7 * (2 * cmath.exp(0.4j) + 3 * cmath.exp(-1.1j))
    assert complex(float(lines[2][2]), float(lines[2][3])) == pytest.approx(by_hand, abs=1e-5)
    by_hand = 0.7 * ((-5 + 4j) * cmath.exp(0.4j) + (0.6 + 9j) * cmath.exp(-1.1j))
    assert complex(float(lines[5][2]), float(lines[5][3])) == pytest.approx(by_hand, abs=1e-5)


def test_both_assemblies_of_the_sample_are_those_that_a_search_over_all_angles_finds():
    scene = DrivenFourBar()
    crank = scene.crank * cmath.exp(1j * scene.start)

    def too_long(beta: float) -> float:
        return abs(crank + scene.coupler * cmath.exp(1j * beta) - complex(*scene.ground)) - scene.rocker

    angles = [2 * math.pi * n / 720 - math.pi for n in range(721)]
    roots = [brentq(too_long, a, b) for a, b in itertools.pairwise(angles) if too_long(a) * too_long(b) < 0]
    found = re.findall(r"\| [+-]1 \| 90\.00 \| (\S+) \| (\S+) \|", text_of(FOUR_BAR))
    assert sorted(float(beta) for beta, _ in found) == pytest.approx(
        sorted(math.degrees(float(root)) for root in roots),  # type: ignore[arg-type]
        abs=0.005,
    )


def test_the_skates_page_proves_that_it_is_the_only_one_and_counts_the_term_once():
    text = text_of(SKATE)
    assert "| (3, 4, -2) | (-0.32, 0.24) m, -36.9° | -25 |" in text
    assert "| (0, 0, 1) | none | 0 |" in text
    assert "are\n1.000000000000 and 2.000000000000." in text


def test_the_errata_link_to_headings_that_are_there_and_state_whose_tolerance_it_is():
    text = text_of(ERRATA)
    assert "at a relative tolerance of 1e-3" in text
    assert "the tolerance is ours, since the chapter states none" in text
    for page in (FOUR_BAR, SKATE, PENDULUM):
        (target,) = re.findall(rf"\]\({page.name}\.md#([^)]+)\)", text)
        assert target in {anchor(heading) for heading in headings(text_of(page))}
