"""The lessons, each of which is a Markdown file in this folder. reports/site/lesson.py describes its form."""

from pathlib import Path

from reports.site.lesson import read_lesson
from reports.site.live.scenes import SCENES

# The names of the lessons by the chapter's types of problems, in the chapter's order.
ORDER = {
    "I. Open and closed chains": ("pendulum", "chains", "slider_crank", "four_bar"),
    "II. Rolling": ("rolling", "gears", "centrodes", "cam"),
    "III. Skates and wheels": ("skate", "parking", "wheels"),
    "The text of the chapter": ("errata",),
}
PROBLEMS = {
    problem: tuple(read_lesson(Path(__file__).with_name(f"{name}.md"), SCENES) for name in names)
    for problem, names in ORDER.items()
}
LESSONS = tuple(lesson for lessons in PROBLEMS.values() for lesson in lessons)
