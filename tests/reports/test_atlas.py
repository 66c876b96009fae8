"""Tests of the failure atlas: columns, predictions, file, page and command."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from engines import Regularisation, method_name
from engines.registry import VARIANTS
from reference.mechanism import Mechanism
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reports.model.ending import FINE, REFUSED
from reports.model.outcomes import TORN
from reports.pages.atlas import maps, page
from reports.pages.atlas.maps import FILE, MAPS, NOT_RUN, MapColumn, StabilityMap, StoredColumn
from reports.run.running import run_items
from tests.reports.test_command_line import call, one_line
from tests.toys import Disc, FailingToy, Toy

SHOWN = tuple(engine for engine in VARIANTS if engine.variant in ("default", "tuned"))
TOYS = StabilityMap(
    "toys", "Toys", "rate [rad/s]", lambda rate: Disc(rate=rate), (1.0, 100.0), lambda scene: scene.rate, "the disc"
)


def line(
    value: float, outcomes: str, engine: str = "toy", gives: float = math.nan, left: float = math.nan
) -> StoredColumn:
    counts = tuple(10 * 2**index for index in range(len(outcomes)))
    errors = tuple(-1.5 if letter == "·" else math.nan for letter in outcomes)
    return StoredColumn("toys", engine, "default", value, 0.1, counts, outcomes, errors, gives, left)


def test_every_map_has_scenes_steps_and_a_frequency_over_its_whole_range():
    for failure_map in MAPS:
        values, steps = failure_map.at(40), failure_map.steps(40)
        assert len(steps) == 40
        assert (values[0], values[-1]) == pytest.approx(failure_map.values)
        assert all(np.diff(values) > 0)
        assert len({samples for samples, _ in steps}) <= 11
        for value in (values[0], values[-1]):
            assert 0 < failure_map.frequency(failure_map.make(value)) < math.inf


def test_frequencies_of_maps_agree_with_closed_forms_and_fine_grids():
    # The squared frequency of one bar is 3/2 g/l. Two equal bars have the squared frequencies (3 +- 6/sqrt(7)) g/l.
    assert maps.stiffest_hanging(LinkPendulum(links=1)) == pytest.approx(math.sqrt(1.5 * 9.81), rel=1e-12)
    two = LinkPendulum(links=2, length=0.7)
    assert maps.stiffest_hanging(two) == pytest.approx(math.sqrt((3 + 6 / math.sqrt(7)) * 9.81 / 0.7), rel=1e-12)
    scene = maps.near_the_largest_offset(1e-3)
    angles = np.linspace(0, 2 * math.pi, 200_001)
    assert maps.rod_rate(scene) == pytest.approx(np.abs(scene.shape.rates(angles)[0]).max() * scene.rate, rel=1e-3)
    # An ellipse with semi-axes a > b oscillates about its flat side with omega^2 = m g (a^2/b - b) / (I + m b^2).
    a, b = 0.5, 0.1
    inertia = (a**2 + b**2) / 4
    assert maps.rocking(maps.ellipse(b / a)) == pytest.approx(
        math.sqrt(9.81 * (a**2 / b - b) / (inertia + b**2)), rel=1e-3
    )


@dataclass
class Soft:
    """An engine with a regularisation. With `tied`, its stiffness is `stiffness` / dt^2."""

    stiffness: float
    compliance: float = 0.1
    complete: bool = True
    tied: bool = False

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation:
        stiffness = self.stiffness / dt**2 if self.tied else self.stiffness
        return Regularisation(stiffness, 1.0, self.compliance, (True,) * mechanism.row_count, self.complete)


def test_at_the_tearing_step_the_weight_opens_the_joint_by_the_bound():
    """The disc turns about its centre, so the pin carries only the weight. Gravity is 10 m/s^2."""
    scene, mechanism = Disc(), Disc().mechanism()
    limit = 10 * 0.1 / (TORN * mechanism.length_scale)

    def gives(soft: Soft) -> float:
        return maps.tearing_step(scene, mechanism, soft, 1e-3, 1e-1)  # type: ignore[arg-type]

    assert [gives(Soft(limit * 0.99)), gives(Soft(limit * 1.01))] == [0.0, math.inf]
    # The tearing step is 1e-2 s; 81 steps over two decades are searched.
    assert gives(Soft(limit * 1e-4, tied=True)) == pytest.approx(1e-2, rel=0.07)
    # The pin does not move, so an engine without the velocity term has no error.
    assert gives(Soft(1.0, 0.0, complete=False)) == math.inf


def test_without_the_velocity_term_the_centripetal_acceleration_determines_the_tearing_step():
    """A bar turns about its pin without gravity, so the velocity term is the acceleration of its middle, rate^2 l/2."""
    scene = BarPendulum(gravity=1e-9, angle=0.0, rate=2.0, duration=1.0)
    mechanism = scene.mechanism()
    limit = scene.rate**2 * scene.length / 2 / (TORN * mechanism.length_scale)
    for factor, step in ((0.99, 0.0), (1.01, math.inf)):
        soft = Soft(limit * factor, 0.0, complete=False)
        assert maps.tearing_step(scene, mechanism, soft, 1e-3, 1e-1) == step  # type: ignore[arg-type]


def drawn_of(outcomes: str, stride: int) -> tuple[str, str]:
    """The letters that are stored for a column with these outcomes, and the letters that are drawn."""
    column = MapColumn(TOYS, 1.0, Disc(), Toy(), tuple((10, every) for every in range(1, len(outcomes) + 1)))
    run = lambda cells: {cell: SimpleNamespace(outcome=outcomes[cell.every - 1]) for cell in cells}  # noqa: E731
    rows: Any = maps.run_columns([column], run, stride)[0]  # type: ignore[arg-type]
    stored = "".join(rows[index].outcome if index in rows else NOT_RUN for index in range(len(outcomes)))
    assert line(1.0, stored).run_count == len(rows)
    return stored, "".join(outcome.letter for outcome in line(1.0, stored).outcome_of_steps)


def test_bisection_finds_each_border_of_regions_that_are_wider_than_the_stride():
    for border in range(1, 21):
        outcomes = "T" * border + "S" * 7 + "·" * (27 - border)
        stored, displayed = drawn_of(outcomes, 4)
        assert displayed == outcomes
        assert NOT_RUN in stored
        assert drawn_of(outcomes, 1) == (outcomes, outcomes)
    # A narrower region is found only if one of its steps is run.
    assert drawn_of("····S····", 4) == ("·=··S··=·", "····S····")
    assert drawn_of("··S······", 4) == ("·===·===·", "·········")
    assert drawn_of("SS", 4) == ("SS", "SS")
    assert drawn_of("S", 4) == ("S", "S")


def test_a_stored_column_has_errors_of_finished_runs_and_an_abort_affects_its_own_cells_only():
    steps = tuple((10, every) for every in range(1, 6))
    columns = [MapColumn(TOYS, 2.0, Disc(), engine, steps) for engine in (Toy(), FailingToy("abort"))]
    rows = maps.run_columns(columns, lambda cells: dict(run_items(cells, workers=1)), 4)
    lines = [maps.stored_column(column, some) for column, some in zip(columns, rows, strict=True)]
    assert [stored.outcomes for stored in lines] == ["·===·", "A===A"]
    assert [math.isnan(error) for error in lines[0].errors] == [letter == NOT_RUN for letter in lines[0].outcomes]
    assert lines[0].errors[0] == pytest.approx(math.log10(rows[0][0].angle), abs=0.05)
    assert all(math.isnan(error) for error in lines[1].errors)


def test_at_the_largest_step_and_below_all_errors_are_within_the_bound():
    inf = float("inf")
    assert page.largest_step([line(1.0, "·S··"), line(2.0, "TTS·")], inf) == "12 ms"
    assert page.largest_step([line(1.0, "·S··")], inf) == "25 ms"
    assert page.largest_step([line(1.0, "···T")], inf) == "-"
    # The errors are 0.1, 0.01, unknown and 0.001 rad. The step that was not run counts with the error 0.01 rad.
    falling_line = replace(line(1.0, "··=·"), errors=(-1.0, -2.0, float("nan"), -3.0))
    largest = [page.largest_step([falling_line], bound) for bound in (inf, 0.011, 0.01, 1e-4)]
    assert largest == ["100 ms", "50 ms", "12 ms", "-"]
    assert page.agreement(
        [line(1.0, "TT··", gives=0.1), line(2.0, "TT··", gives=0.3), line(3.0, "····", gives=0.1)]
    ) == (1, 2)


def test_the_command_writes_its_file_and_continues_an_earlier_run(monkeypatch, tmp_path, capsys, at_home):
    monkeypatch.chdir(tmp_path)
    text = ("atlas", "--scenes", "length", "--points", "3", "--workers", "1")
    assert call(*text) == FINE
    folder = tmp_path / "crosscheck-results" / "atlas"
    result = maps.read(folder / FILE)
    assert {item.method for item in result} == {method_name(engine) for engine in SHOWN}
    assert all(len(item.outcomes) == 3 for item in result)
    assert f"{3 * 3 * len(SHOWN)} of {3 * 3 * len(SHOWN)} cells were run" in capsys.readouterr().out
    assert call(*text) == FINE
    assert f"0 of {3 * 3 * len(SHOWN)} cells were run" in capsys.readouterr().out
    for unknown in ("lenght", ","):
        assert call("atlas", "--scenes", unknown) == REFUSED
        assert "length" in one_line(capsys.readouterr().err)
