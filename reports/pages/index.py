"""The index of all pages with what users see go wrong, in their words; and the readme's parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from engines import Engine
from reference.scene import Scene
from reports.model.convergence import judged
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.usual_steps import USUAL_STEPS
from reports.pages import comparison
from reports.pages.findings import findings
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.write import unmeasured
from reports.write.columns import BUDGET, equal_cost, equal_error, equal_step
from reports.write.page_tables import TARGETS
from reports.write.provenance import machine, versions
from reports.write.templates import environment, inert_page, link, with_part


@dataclass(frozen=True)
class Symptom:
    """`seen` as a user would say it, a short `answer`, and the page that has the rest, under `heading` if not empty."""

    seen: str
    answer: str
    page: str
    heading: str


SYMPTOMS: tuple[Symptom, ...] = (
    Symptom(
        "My closed loop opens, or is off at every step (MuJoCo).",
        "As shipped its pin is a spring of 20 ms. Tie `solref` to the step and raise `solimp`, in MuJoCo 3.7 or later.",
        "your_loop",
        "Your loop in MuJoCo",
    ),
    Symptom(
        "My joints drift apart, or give like rubber (pymunk).",
        "Close the whole gap in every step, with as many iterations as a trial on a copy shows to be enough.",
        "your_loop",
        "Your loop in pymunk",
    ),
    Symptom(
        "A smaller step makes it worse.",
        "Either two errors cancelled at the larger one, or there are too few iterations.",
        "four_bar",
        "Worse as the step shrinks",
    ),
    Symptom(
        "How many iterations do I need?",
        "That depends on the masses as well as on the number of bodies.",
        "person",
        "A heavy trunk on light shanks, with too few sweeps",
    ),
    Symptom(
        "My frictionless pendulum slows down (pymunk).",
        "A smaller step helps in proportion, `error_bias = 0` at once.",
        "pendulum",
        "",
    ),
    Symptom(
        "A heavy body on a light chain: the chain stretches.",
        "A map of mass ratios and steps says what still works.",
        "atlas",
        "A pendulum of three links with a heavy tip",
    ),
    Symptom(
        "How do I drive a crank at a given speed?",
        "As a kinematic body, or with a large armature; neither by a servo nor by overwriting its angle.",
        "four_bar",
        "Five ways to drive a crank",
    ),
    Symptom(
        "I need a skate, a blade or a wheel that can't slip sideways (pymunk).",
        "There is none; five constructions, with code and errors.",
        "skate",
        "How do I put an ideal skate into pymunk?",
    ),
    Symptom(
        "I need a constraint on velocities (MuJoCo).",
        "There is none; tendons and rows that come near, with code and errors.",
        "skate",
        "How do I put an ideal skate into MuJoCo?",
    ),
    Symptom(
        "My wheel or blade creeps down a slope.",
        "MuJoCo's friction creeps by its regularisation; `noslip_iterations` with an elliptic cone stops nearly all.",
        "skate",
        "At rest across a slope",
    ),
    Symptom(
        "There is no slip, but the path is wrong.",
        "Slip alone proves nothing: a naive skate has none.",
        "skate",
        "No slip at all, and a wholly wrong motion",
    ),
    Symptom(
        "My car or cart drives, but not where it should.",
        "Two wheels of one axle, trailers and casters, each against the exact motion.",
        "wheels",
        "How a vehicle can still move",
    ),
    Symptom(
        "My groove joint comes apart (pymunk).",
        "A `GrooveJoint` is always right only if its anchor is a centre of mass and the grooved body can't turn.",
        "slider_crank",
        "The rod's end in a groove",
    ),
    Symptom(
        "My linkage flips into the other assembly.",
        "Where all bars lie in line the motion has two ways to go on.",
        "n_four_bar",
        "Through the singular position, as shipped",
    ),
    Symptom(
        "Gears, cams or ellipses roll wrongly.",
        "MuJoCo's contact leaves out the motion of the contact itself; pymunk's polygons roll over corners.",
        "rolling",
        "Polygons",
    ),
    Symptom(
        "The joint forces look wrong.",
        "Which number is which force, with which sign, and why it may be wrong although the motion is right.",
        "settings",
        "Reactions",
    ),
    Symptom(
        "My chain of hundreds of bodies is too slow.",
        "In MuJoCo a tree costs more than free bodies with sparse rows beyond a hundred links or so.",
        "scaling",
        "Cost of a step",
    ),
)


def foot(command: str, engines: Iterable[Engine] = ()) -> str:
    """What the page was made with, its engines that are not registered included."""
    return f"Made by `{command}` with {versions(engines)}; timings on {machine()}."


def engines_of(pages: Iterable[Page]) -> list[Engine]:
    """Every engine that these pages compare."""
    return list(dict.fromkeys(engine for page in pages for engine in page.engines))


def render_index(pages: Mapping[Page, Material], command: str, files: Mapping[str, str] = MappingProxyType({})) -> str:
    """The index: findings, symptoms, every scene in a line, every page with its lesson. `files`: what is beside it."""
    entries = [(page, _overview_rows(page, material, page.scenes)) for page, material in pages.items()]
    known = {page.name for page in pages}
    text = (
        environment()
        .get_template("index.md")
        .render(
            pages=list(pages),
            titles={page.name: page.title for page in pages},
            findings=findings(pages),
            symptoms=[(each, link(each.page, each.heading, files)) for each in SYMPTOMS if each.page in known],
            compared=comparison.table(comparison.compared_lines(pages)),
            equal_cost=equal_cost(entries),
            equal_error=equal_error(entries),
            equal_step=equal_step(entries),
            budget=1e3 * BUDGET,
            targets=TARGETS,
            steps=list(USUAL_STEPS),
            outcomes=list(Outcome),
            files=files,
            foot=foot(command, engines_of(pages)),
        )
    )
    return inert_page(unmeasured.without_marks(text))


def _overview_rows(page: Page, material: Material, scenes: Sequence[Scene]) -> list[Measurement]:
    return judged([*material.sweep(scenes), *material.usual(scenes)], page.quantity)


def render_readme(text: str, pages: Mapping[Page, Material]) -> str:
    """The readme with the lines of `your_loop` and their errors. Nothing in it depends on timings.

    Raises ValueError where the marks of the part are missing.
    """
    material = next((given for page, given in pages.items() if page.name == YOUR_LOOP.name), Material({}))
    told = environment().get_template(f"{YOUR_LOOP.name}/readme.md").render(dict(YOUR_LOOP.words(material)))
    return with_part(text, "loop", unmeasured.without_marks(told).strip())
