"""The lessons with their scenes and experiments. The text of a lesson is a Markdown file in this folder."""

from engines import Engine
from reference.scene import Scene
from reports.site.animated import Take
from reports.site.lessons.chains import CHAINS
from reports.site.lessons.errata import ERRATA
from reports.site.lessons.linkages import CENTRODES, FOUR_BAR, PENDULUM, SLIDER_CRANK
from reports.site.lessons.rolling import CAM, GEARS, ROLLING
from reports.site.lessons.skates import PARKING, SKATE, WHEELS

# The lessons by the chapter's types of problems, in the chapter's order.
PROBLEMS = {
    "I. Open and closed chains": (PENDULUM, CHAINS, SLIDER_CRANK, FOUR_BAR),
    "II. Rolling": (ROLLING, GEARS, CENTRODES, CAM),
    "III. Skates and wheels": (SKATE, PARKING, WHEELS),
    "The text of the chapter": (ERRATA,),
}
LESSONS = tuple(lesson for lessons in PROBLEMS.values() for lesson in lessons)


def take_like(scene: Scene, methods: tuple[tuple[str, Engine, int], ...]) -> Take:
    """Return a take of a scene with these methods. The take has the look of the scene in a lesson."""
    plain = next((live for lesson in LESSONS for live in lesson.scenes if live.scene.name == scene.name), None)
    if plain is None:
        return Take(scene, methods)
    bodies = {body.name for body in scene.mechanism().bodies}
    ends = {body: points for body, points in plain.ends.items() if body in bodies}
    return Take(scene, methods, ends=ends, axle=plain.axle)
