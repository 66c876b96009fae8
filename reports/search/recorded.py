"""What an adapter tells a package, as lines of Python that tell it again: a script that needs the package alone."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest import mock

import numpy as np

PLAIN = (type(None), bool, int, float, str, bytes, np.generic, np.ndarray)


class Recorder:
    """The lines, and by the name of a function the words for what it gave, in order."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.made: dict[str, list[str]] = {}

    def seen(self, value: Any, words: str) -> Any:
        """What stands for a value of the package: itself if it is plain data, which is then written as such."""
        if isinstance(value, PLAIN) or type(value) in (tuple, list, dict):
            return value
        return Seen(self, value, words)

    def called(self, function: Any, words: str, given: tuple[Any, ...], named: dict[str, Any]) -> Any:
        """The function's value; the call is a line, and what it gives has a name if it is no data but a number."""
        told = [text(each) for each in given] + [f"{name}={text(each)}" for name, each in named.items()]
        result = function(*map(bare, given), **{name: bare(each) for name, each in named.items()})
        call = f"{words}({', '.join(told)})"
        if isinstance(result, PLAIN) and not (type(result) is int or isinstance(result, np.ndarray)):
            self.lines.append(call)
            return result
        name = f"x{len(self.lines)}"
        self.lines.append(f"{name} = {call}")
        self.made.setdefault(words.rpartition(".")[2], []).append(name)
        return Number(result, name) if type(result) is int else self.seen(result, name)


class Number(int):
    """A whole number that a package gave for one of its objects, with the words for it."""

    def __new__(cls, value: int, words: str) -> Number:
        made = super().__new__(cls, value)
        made.words = words
        return made

    words: str


class Seen:
    """Stands for an object of the package, and records what is done with it."""

    def __init__(self, recorder: Recorder, value: Any, words: str) -> None:
        self.__dict__.update(recorder=recorder, value=value, words=words)

    def __getattr__(self, name: str) -> Any:
        return self.recorder.seen(getattr(self.value, name), f"{self.words}.{name}")

    def __setattr__(self, name: str, value: Any) -> None:
        self.recorder.lines.append(f"{self.words}.{name} = {text(value)}")
        setattr(self.value, name, bare(value))

    def __getitem__(self, key: Any) -> Any:
        return self.recorder.seen(self.value[bare(key)], f"{self.words}[{text(key)}]")

    def __setitem__(self, key: Any, value: Any) -> None:
        self.recorder.lines.append(f"{self.words}[{text(key)}] = {text(value)}")
        self.value[bare(key)] = bare(value)

    def __add__(self, other: Any) -> Any:
        return self.recorder.seen(self.value + bare(other), f"({self.words} + {text(other)})")

    def __call__(self, *given: Any, **named: Any) -> Any:
        return self.recorder.called(self.value, self.words, given, named)


def bare(value: Any) -> Any:
    """The package's own value for what stands for it."""
    if isinstance(value, Seen):
        return value.value
    if type(value) in (list, tuple):
        return type(value)(map(bare, value))
    return value


def text(value: Any) -> str:
    """A value as Python; a file as what is written into one again."""
    match value:
        case Seen() | Number():
            return value.words
        case list():
            return f"[{', '.join(map(text, value))}]"
        case tuple():
            return f"({''.join(f'{text(each)}, ' for each in value)})"
        case np.ndarray():
            return f"np.array({value.tolist()!r})"
        case np.generic():
            return repr(value.item())
        case str() if value.endswith(".urdf"):
            return f"written({Path(value).read_text(encoding='utf-8')!r})"
    return repr(value)


@contextmanager
def recording(module: ModuleType, where: str = "") -> Iterator[Recorder]:
    """Adapters that import this package in here get what records; `where`: a function of theirs that gives it."""
    recorder = Recorder()
    seen = Seen(recorder, module, module.__name__)
    found: Callable[[], Any] = lambda: seen  # noqa: E731
    with mock.patch(where, found) if where else mock.patch.dict(sys.modules, {module.__name__: seen}):  # type: ignore[dict-item]
        yield recorder


def repeated(lines: list[str]) -> list[str]:
    """The same lines, those that follow on themselves as a loop."""
    out: list[str] = []
    number = 0
    while number < len(lines):
        many = 1
        while number + many < len(lines) and lines[number + many] == lines[number]:
            many += 1
        out += [lines[number]] if many == 1 else [f"for _ in range({many}):", f"    {lines[number]}"]
        number += many
    return out
