"""Reads models of other authors. For each model the table has the number of bodies or the reason of a refusal.

`python -m tests.reports.models_of_others` writes the table of the page `your_model`. The module downloads two packages
with pip into a temporary folder, and runs pymunk's examples without windows.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import mujoco
import pymunk

from engines import Unsupported
from engines.mujoco.reading import READER
from engines.reading import ReadingTerms
from reference.checks import InvalidMechanism
from reports.check.judging import refuse_disagreement
from reports.pages.your_model.page import TRIED_MODELS
from tests import ROOT

EXAMPLES = Path(pymunk.__file__).parent / "examples"
ASK = """
import json, os, runpy, signal, sys
from unittest.mock import MagicMock

for name in ("pygame", "pygame.locals", "pygame.color", "pygame.font", "pyglet", "pyglet.gl", "pyglet.window"):
    sys.modules[name] = MagicMock()
import pymunk

for name in ("pygame_util", "pyglet_util"):
    sys.modules[f"pymunk.{name}"] = MagicMock()
    setattr(pymunk, name, sys.modules[f"pymunk.{name}"])

class Stepped(BaseException):
    pass

def step(space, dt):
    raise Stepped(space, dt)

own, pymunk.Space.step = pymunk.Space.step, step
pymunk.Space.debug_draw = lambda space, options: None
# Of the processor's time, since a loaded machine may take any time; the other ends what waits for ever.
signal.setitimer(signal.ITIMER_PROF, 20)
signal.alarm(900)
try:
    runpy.run_path(sys.argv[1], run_name="__main__")
    print(json.dumps(None))
except Stepped as stepped:
    space, dt = stepped.args
    pymunk.Space.step = own
    from engines.pymunk.reading import read
    from tests.reports.models_of_others import tried
    print(json.dumps(tried(lambda without: read(space, dt, without))))
except BaseException as reason:
    print(json.dumps(None))
"""


@dataclass(frozen=True)
class Found:
    """One line of the table. `without`: elements that were switched off. `reason`: why the model is refused, or ""."""

    source: str
    model: str
    bodies: str
    without: str
    reason: str


def tried(reading) -> list[str]:
    """[bodies, without, reason] of a model. If a refusal advises an option `--without`, the model is read again with
    it."""
    without: list[str] = []
    while True:
        try:
            result = reading(tuple(without))
            off = refuse_disagreement(result)
            assert off < 1e-6, off
            return [str(len(result.mechanism.bodies)), " ".join(without), ""]
        except (Unsupported, InvalidMechanism, ValueError) as reason:
            text = " ".join(str(reason).split())
            advised = re.search(r"--without (\w+)", text)
            switch = None if advised is None else advised[1]
            if switch is None or switch in without:
                return ["", " ".join(without), text]
            without.append(switch)


def spaces() -> Iterator[Found]:
    """The table's lines for pymunk's examples, which are run without a window."""
    for path in sorted(EXAMPLES.glob("*.py")):
        if path.name.startswith("_"):
            continue
        reported = subprocess.run(
            [sys.executable, "-c", ASK, str(path)],
            cwd=ROOT,
            env={"PYTHONPATH": f"{ROOT}{os.pathsep}{EXAMPLES}", "PATH": ""},
            capture_output=True,
            text=True,
        )
        lines = reported.stdout.splitlines()
        if reported.returncode or not lines:
            yield Found("pymunk", path.stem, "", "", "crashed")
        elif (answer := json.loads(lines[-1])) is not None:
            yield Found("pymunk", path.stem, *answer)


def unpacked(folder: Path) -> bool:
    """Unpack Gymnasium and dm_control into a folder. The result is False if pip can't download them."""
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(folder)]
    if subprocess.run([*command, "gymnasium", "dm_control"], capture_output=True).returncode:
        return False
    for wheel in folder.glob("*.whl"):
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(folder / wheel.name.split("-")[0])
    return True


def models(folder: Path) -> Iterator[Found]:
    """The table's lines for the models in MuJoCo's package and in the packages in `folder`."""
    places = {
        "mujoco": Path(mujoco.__file__).parent / "testdata",
        "gymnasium": folder / "gymnasium/gymnasium/envs/mujoco/assets",
        "dm_control": folder / "dm_control/dm_control/suite",
    }
    for source, model_folder in places.items():
        for path in sorted(model_folder.glob("*.xml")):
            answer = tried(lambda without, path=path: READER.read(path.name, path.parent, ReadingTerms(without)))
            yield Found(source, path.stem, *answer)


def main() -> int:
    with tempfile.TemporaryDirectory() as folder:
        if not unpacked(Path(folder)):
            print("pip finds no packages here", file=sys.stderr)
            return 1
        rows = [*models(Path(folder)), *spaces()]
    out = io.StringIO()
    writer = csv.DictWriter(out, list(asdict(rows[0])), lineterminator="\n")
    writer.writeheader()
    writer.writerows(map(asdict, rows))
    TRIED_MODELS.write_text(out.getvalue(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
