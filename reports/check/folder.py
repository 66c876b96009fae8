"""The models in a folder, and the results of their checks as a table, as JSON data and as JUnit XML."""

from __future__ import annotations

import re
import xml.etree.ElementTree as xml
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from reports.check.request import CheckReport, CheckRequest, Refused

FOLDER_HEADER = ("model", "off by", "why", "advice", "its error", "CPU, times yours")
BYTES_READ = 65536  # The first bytes of a file are searched for a tag or an import.
MODEL_TAG = re.compile(rb"<(mujoco|robot)[\s/>]")
PYMUNK_IMPORT = re.compile(rb"^(import|from) pymunk\b", re.MULTILINE)
Answers = Sequence[tuple[CheckRequest, CheckReport | Refused]]


def find_models(folder: Path) -> list[Path]:
    """MuJoCo models, URDF models, and scripts that import pymunk, in a folder and its subfolders, sorted by name."""
    kinds = {".xml": MODEL_TAG, ".mjcf": MODEL_TAG, ".urdf": MODEL_TAG, ".py": PYMUNK_IMPORT}
    paths = []
    for path in sorted(folder.rglob("*")):
        wanted = kinds.get(path.suffix.lower())
        hidden = any(part.startswith(".") for part in path.relative_to(folder).parts)
        if wanted is None or hidden or not path.is_file():
            continue
        with path.open("rb") as file:
            if wanted.search(file.read(BYTES_READ)):
                paths.append(path)
    return paths


def rows(answers: Answers) -> list[tuple[str, ...]]:
    """The rows of a table with the columns FOLDER_HEADER. Every model has a row."""
    return [
        (request.word, "-", f"refused: {_short(request, answer)}", "-", "-", "-")
        if isinstance(answer, Refused)
        else (request.word, *answer.line)
        for request, answer in answers
    ]


def document(answers: Answers) -> list[dict[str, Any]]:
    """The JSON document of each model. A refused model has the reason (`reports.check.document.schema`)."""
    return [
        {"model": request.word, "refused": answer.sentence, "found": None}
        if isinstance(answer, Refused)
        else {"model": request.word, "refused": None, "found": answer.data}
        for request, answer in answers
    ]


def _short(request: CheckRequest, answer: Refused) -> str:
    return answer.sentence.removeprefix(f"{request.word}: ")


def junit_xml(answers: Answers, seconds: float) -> str:
    """JUnit XML with a test for each model. A test fails if the tolerance is missed; a refused model is skipped."""
    missed = sum(isinstance(answer, CheckReport) and not answer.fine for _, answer in answers)
    refused = sum(isinstance(answer, Refused) for _, answer in answers)
    counts = {"tests": str(len(answers)), "failures": str(missed), "errors": "0", "skipped": str(refused)}
    root = xml.Element("testsuites", counts)
    suite = xml.SubElement(root, "testsuite", {"name": "crosscheck check", **counts, "time": f"{seconds:.1f}"})
    for request, answer in answers:
        case = xml.SubElement(suite, "testcase", {"classname": "crosscheck.check", "name": request.word})
        if isinstance(answer, Refused):
            xml.SubElement(case, "skipped", {"message": _short(request, answer)})
        elif not answer.fine:
            failure = xml.SubElement(case, "failure", {"message": answer.verdict})
            facts = (f"{label}: {sentence}" for label, sentence in answer.answer.facts)
            failure.text = "\n".join([*facts, *answer.answer.code])
    xml.indent(root)
    return xml.tostring(root, encoding="unicode", xml_declaration=True) + "\n"
