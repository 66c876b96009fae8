"""What the templates of a lesson and of the first page are given: words, pictures, the data of motions."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping

from markupsafe import Markup

from reports.site import markdown
from reports.site.embed import data, picture, shown
from reports.site.lesson import Lesson
from reports.site.markdown import Formulas
from reports.site.source import Source

OWN_FILE = re.compile(r'(href|src)="(?!https?:|#|mailto:|\.\./)([^"]+)"')
Elsewhere = Callable[[str], str]


def lesson_page(
    lesson: Lesson, source: Source, formulas: Formulas, names: Mapping[str, str], elsewhere: Elsewhere
) -> dict[str, object]:
    """For lesson.html; `names`: pages by the Markdown file's name, `elsewhere`: where other files stand."""
    takes = {name: shown(take, source.answers) for name, take in lesson.takes.items()}

    def words(text: str) -> str:
        return markdown.html(text, formulas)

    def quoted(text: str) -> Markup:
        """A part of a page of results, without the anchors that it has there; its files stand in another folder."""
        told = markdown.linked(re.sub(r' id="[^"]*"', "", words(text)), names, elsewhere)
        return Markup(OWN_FILE.sub(r'\1="../results/\2"', told))

    steps = []
    for index, ((heading, text), step) in enumerate(zip(lesson.words, lesson.steps, strict=True)):
        more = None
        if step.section is not None and f"{step.section[0]}.md" in source.pages:
            page, part = step.section
            text_there = markdown.section(source.pages[f"{page}.md"], part)
            if text_there is not None:  # a page made of few rows lacks some parts
                href = f"../results/{page}.html#{markdown.slug(part)}"
                more = {"heading": part, "href": href, "body": quoted(text_there)}
        steps.append(
            {
                "number": index + 1,
                "heading": heading,
                "words": Markup(words(text)),
                "take": step.take,
                "shown": takes[step.take],
                "picture": Markup(picture(takes[step.take], f"{lesson.title}: {heading}")),
                "on": sorted(step.switched_on),
                "broken": step.broken,
                "pictures": {
                    name: Markup(picture(takes[name], f"{lesson.title}: {word}")) for word, name, _ in step.broken
                },
                "more": more,
            }
        )
    return {
        "title": lesson.title,
        "lesson": lesson,
        "steps": steps,
        "takes": {name: _json(data(take)) for name, take in takes.items()},
    }


def front_page(lesson: Lesson, source: Source) -> dict[str, object]:
    """For index.html, with a motion of this lesson."""
    take = shown(lesson.takes["free"] if "free" in lesson.takes else next(iter(lesson.takes.values())), source.answers)
    return {
        "figure": Markup(picture(take, "A four-bar linkage falls: the truth, and two engines over it")),
        "take": _json(data(take)),
        "shown": take,
        "results": [
            (name, markdown.title(text)) for name, text in source.pages.items() if not name.endswith("_data.md")
        ],
    }


def _json(value: object) -> Markup:
    """JSON that can stand in a script element."""
    return Markup(json.dumps(value, allow_nan=False, separators=(",", ":")).replace("</", "<\\/"))
