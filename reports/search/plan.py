"""The cases of the published page with seeds from the commit's hash, and batches of cases with random seeds."""

from __future__ import annotations

import secrets
import subprocess
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import count

from engines import Engine, Unsupported
from engines.registry import INSTALLED, VARIANTS
from reports.model.fingerprint import OURS, ROOT, SHORT, digest
from reports.search import mechanisms
from reports.search.chunk import Chunk, make_chunks
from reports.search.mujoco_alone import HINGED_KINDS
from reports.search.parts import ALL_KINDS, TOGGLE
from reports.search.recipe import build
from reports.search.subjects import DEFAULT_ORACLES, Adapted, Alone, Subject, is_shaped

COMMIT_RULE, SOURCES_RULE = "the last commit's hash", "the SHA-256 of all sources, as there is no git"
SEED_DECADES = (0, 2, 4)  # Decades by seed.
PLANNED_CASES, ALONE_CASES = 100, 1000  # Number of cases of a seed for an engine, and for MuJoCo alone.
# Number of cases of a seed for MJX, which compiles each shape. A case takes three seconds in MJX, and 0.005 to 0.8 s in
# other engines.
COMPILED_CASES = 20
SINGULAR_CASES = 60  # Number of cases with nearly dependent rows, for engines with pins and rods.
KIND_TRIALS = 60  # Number of mechanisms that are tried for one kind of joint.


@cache
def seed_origin() -> tuple[str, str]:
    """A rule and the text from which seeds are computed. The text is the hash of the last commit, or the hash of all
    sources if there is no git."""
    if (ROOT / ".git").exists():
        command = ["git", "-C", str(ROOT), "rev-parse", "HEAD"]
        answer = subprocess.run(command, capture_output=True, text=True, check=False)
        if answer.returncode == 0:
            return COMMIT_RULE, answer.stdout.strip()
    files = sorted(path for folder in OURS for path in (ROOT / folder).rglob("*.py"))
    return SOURCES_RULE, digest(b"\0".join(path.read_bytes() for path in files), 64)


def published_seeds() -> tuple[int, ...]:
    """Seeds from the SHA-256 of "ORIGIN NUMBER" with numbers from 1. A seed is half of the first eight hexadecimal
    digits."""
    texts = (f"{seed_origin()[1]} {number}" for number in range(1, len(SEED_DECADES) + 1))
    return tuple(int(digest(text, SHORT), 16) // 2 for text in texts)


@cache
def supported_kinds(engine: Engine) -> tuple[str, ...]:
    """The kinds of joints and forces that an engine builds in at least one of KIND_TRIALS mechanisms."""
    return tuple(kind for kind in ALL_KINDS if any(_is_built(engine, kind, number) for number in range(KIND_TRIALS)))


def _is_built(engine: Engine, kind: str, number: int) -> bool:
    recipe = mechanisms.recipe(0, number, ("pin", kind))
    if kind not in recipe.kinds:
        return False
    mechanism = build(recipe)
    try:
        engine.build(mechanism, mechanism.time_scale / 100)
    except Unsupported:
        return False
    return True


def all_subjects() -> list[Subject]:
    return [*(Adapted(engine) for engine in (*VARIANTS, *INSTALLED)), Alone()]


def published_chunks() -> list[Chunk]:
    """All engines in mechanisms of the commit's seeds, with the kinds that the engine supports. There are separate
    chunks for nearly dependent rows.
    """
    out: list[Chunk] = []
    for seed, decades in zip(published_seeds(), SEED_DECADES, strict=True):
        for subject in all_subjects():
            kinds, alone, shaped = _kinds(subject), isinstance(subject, Alone), is_shaped(subject)
            many = ALONE_CASES if alone else COMPILED_CASES if shaped else PLANNED_CASES
            out += make_chunks([subject], seed, many, kinds, 0 if alone else decades, DEFAULT_ORACLES)
            if decades == 0 and {"pin", "rod"} <= {*kinds} and not shaped:
                near = [kind for kind in ("pin", "spring", "force") if kind in kinds]
                out += make_chunks([subject], seed, SINGULAR_CASES, (*near, TOGGLE), 0, DEFAULT_ORACLES)
    return out


def fresh_chunks(subjects: Sequence[Subject], cases: int) -> Iterator[list[Chunk]]:
    """Yield an endless sequence of batches. A batch has a new random seed and `cases` cases of each subject."""
    for number in count():
        seed, decades = secrets.randbits(31), SEED_DECADES[number % len(SEED_DECADES)]
        mixed = secrets.SystemRandom().sample(subjects, len(subjects))  # a short run may end before the last subject
        yield [
            chunk
            for subject in mixed
            for chunk in make_chunks([subject], seed, cases, _kinds(subject), decades, DEFAULT_ORACLES)
        ]


def _kinds(subject: Subject) -> tuple[str, ...]:
    return supported_kinds(subject.engine) if isinstance(subject, Adapted) else HINGED_KINDS
