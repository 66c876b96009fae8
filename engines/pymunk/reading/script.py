"""A script that makes a space: run until it has one or steps one, and written anew with other settings."""

from __future__ import annotations

import ast
import contextlib
import io
import os
import sys
import traceback
import types
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any

import pymunk

from engines.pymunk.reading.own_model import start_ahead
from engines.reading import Change, refuse

MODULE = "crosscheck_check"  # what a script sees as its __name__
BEGIN, END = "# crosscheck check --apply: these lines are written anew each time", "# crosscheck check --apply: end"
KEPT = {"pymunk", "builtins", "sys", "os", "__main__"}  # two of these would not know each other's objects
PARTS = '''
def in_parts(dt, step={name}.step, space={name}):
    """One step in {parts} equal ones; what pushes a body at its begin pushes it in each of them."""
    pushed = [(body, body.force, body.torque) for body in space.bodies]
    for _ in range(in_parts.parts):
        for body, force, torque in pushed:
            body.force, body.torque = force, torque
        step(dt / in_parts.parts)

in_parts.parts = {parts}
{name}.step = in_parts
'''


@dataclass(frozen=True, eq=False)
class Made:
    """A space as a script made it, before its first step.

    `dt` [s]: by which the script steps it, if it does, in its own parts; `name`: what the space, or the function that
    makes it, is called where `line` stands: before that line, or at the end if it is None, its settings can be changed.
    `parts`: of how many steps one call of the space's own `step` consists, where `rewritten` has made one. `ahead`: a
    first step of half the length has brought the velocities ahead; the space is given as it was before that.
    """

    space: pymunk.Space
    dt: float | None
    name: str
    line: int | None
    function: bool = False
    parts: int = 1
    ahead: bool = False


class _Stepped(BaseException):
    """The script is about to step its space for the first time, or a second time after half a step."""

    def __init__(self, space: Any, dt: float, ahead: bool = False) -> None:
        super().__init__("the script steps its space")
        self.space, self.dt, self.ahead = space, dt, ahead


def made(path: Path, file: str, name: str) -> Made:
    """`_made`, run again where the first step may be the half step that brings velocities ahead: joints that close
    their whole gap, and a second step that is twice as long."""
    found = _made(path, file, name)
    if found.dt is None or not any(joint.error_bias == 0 for joint in found.space.constraints):
        return found
    with contextlib.suppress(ValueError):
        again = _made(path, file, name, found.dt)
        if again.ahead:
            return again
    return found


def _made(path: Path, file: str, name: str, half: float | None = None) -> Made:
    """The space that a script calls `name`, or that a function of this name returns; without a name, its only one.

    The script is stopped before it steps that space; with `half`, after a step of that length. What it prints is
    dropped. Raises ValueError in one line.
    """
    module = types.ModuleType(MODULE)
    module.__file__ = str(path)
    with _at_home(path, module), _stopping(lambda space: _is_wanted(space, module, name), half) as first:
        # Without a name, a script that makes its space only where it is the program is taken as the program.
        for called in (MODULE,) if name else (MODULE, "__main__"):
            module.__dict__["__name__"] = called
            try:
                exec(compile(path.read_bytes(), str(path), "exec"), module.__dict__)
            except _Stepped as stepped:
                return _with_parts(Made(stepped.space, stepped.dt, *_where(path, name, stepped), ahead=stepped.ahead))
            except BaseException as reason:  # of a class of its own, too
                raise _raised(path, file, reason) from None
            if name or _spaces(module) or _guard(path) is None:
                break
        value, word = _named(module, file, name)
        if not callable(value):
            return _checked(file, _started(Made(value, None, word, _guard(path)), first, half))
        with _stopping(lambda space: True, half) as first:
            try:
                space: Any = value()
                return _checked(file, _started(Made(space, None, word, _guard(path), function=True), first, half))
            except _Stepped as stepped:
                return _with_parts(Made(stepped.space, stepped.dt, *_where(path, word, stepped), ahead=stepped.ahead))
            except BaseException as reason:
                raise _raised(path, file, reason) from None


def _started(found: Made, first: _HalfStep, half: float | None) -> Made:
    """A space that was stepped once, if its first step was a half step by lines that start ahead."""
    if half is None or first.space is not found.space or not first.by_lines:
        return found
    first.undo()
    return replace(found, dt=2 * half, ahead=True)


def _checked(file: str, found: Made) -> Made:
    if isinstance(found.space, pymunk.Space):
        return _with_parts(found)
    kind = type(found.space).__name__
    raise ValueError(f"{file}:{found.name}: it is {kind}; it must be a pymunk.Space, or a function that returns one")


def _with_parts(found: Made) -> Made:
    """A step of the script's own is taken off the space: a copy would have it too, and step the wrong space."""
    own = vars(found.space).pop("step", None)
    return replace(found, parts=int(getattr(own, "parts", 1)))


def _raised(path: Path, file: str, reason: BaseException) -> ValueError:
    try:
        words = " ".join(str(reason).split())
    except Exception:
        words = "(its message can't be printed)"
    frames = traceback.extract_tb(reason.__traceback__)
    line = next((f" in line {frame.lineno}" for frame in reversed(frames) if frame.filename == str(path)), "")
    return ValueError(f"{file} raised {type(reason).__name__}{line}{f': {words}' if words else ''}")


def _named(module: types.ModuleType, file: str, name: str) -> tuple[Any, str]:
    """(a value of the script, its name)."""
    values = vars(module)
    if name:
        if name not in values:
            raise ValueError(f"{file}: it has no {name!r}")
        return values[name], name
    spaces = _spaces(module)
    if len({id(space) for space in spaces.values()}) == 1:
        return next(iter(spaces.values())), next(iter(spaces))
    found = f"its spaces are {', '.join(spaces)}" if spaces else "it has no space"
    raise ValueError(
        f"{file}: {found}; give the name of the space, or of a function without arguments that returns one, as in "
        f"{file}:{next(iter(spaces), 'space')}"
    )


def _spaces(module: types.ModuleType) -> dict[str, pymunk.Space]:
    return {word: value for word, value in vars(module).items() if isinstance(value, pymunk.Space)}


@contextlib.contextmanager
def _at_home(path: Path, module: types.ModuleType) -> Iterator[None]:
    """As when a script is run in its own folder: files beside it are found by their names, and modules before others.

    A module of ours, or of Python's, that is called as a file beside the script is out of the way meanwhile.
    """
    home, arguments, paths = os.getcwd(), sys.argv, list(sys.path)
    beside = {file.stem for file in path.parent.glob("*.py")} | {
        file.parent.name for file in path.parent.glob("*/__init__.py")
    }
    hidden = {name: each for name, each in sys.modules.items() if name.partition(".")[0] in beside - KEPT}
    for name in hidden:
        del sys.modules[name]
    sys.modules[MODULE], sys.argv, sys.path[:] = module, [str(path)], [str(path.parent), *paths]
    try:
        os.chdir(path.parent)
        with contextlib.redirect_stdout(io.StringIO()):
            yield
    finally:
        os.chdir(home)
        for name in [name for name in sys.modules if name == MODULE or name.partition(".")[0] in beside - KEPT]:
            del sys.modules[name]
        sys.modules.update(hidden)
        sys.argv, sys.path[:] = arguments, paths


@dataclass
class _HalfStep:
    """The first step of a space, where it may be the half step that brings velocities ahead."""

    space: Any = None
    velocities: tuple[tuple[Any, float], ...] = ()
    by_lines: bool = False  # code that moves bodies back first, or holds them, has called for it

    def begin(self, space: Any, names: Sequence[str]) -> None:
        self.space, bodies = space, list(space.bodies)
        self.velocities = tuple((body.velocity, body.angular_velocity) for body in bodies)
        held = any(body._position_func is not None for body in bodies)
        self.by_lines = held or {"position", "angle", "velocity", "angular_velocity"} <= {*names}

    def undo(self) -> None:
        """The velocities before it: the positions are where they were."""
        for body, (velocity, rate) in zip(self.space.bodies, self.velocities, strict=True):
            body.velocity, body.angular_velocity = velocity, rate


@contextlib.contextmanager
def _stopping(wanted: Any, half: float | None = None) -> Iterator[_HalfStep]:
    """Within it the first step of a space that is `wanted`, and no copy of another, raises _Stepped instead.

    With `half` the first may be made, and the second raises. If it is twice as long, the first is undone.
    """
    step_itself, copy_itself = pymunk.Space.step, pymunk.Space.copy
    copies: list[pymunk.Space] = []  # on which lines of the script try settings
    first = _HalfStep()

    def copy(self: pymunk.Space) -> pymunk.Space:
        copies.append(copy_itself(self))
        return copies[-1]

    def step(self: pymunk.Space, dt: float) -> None:
        if any(self is each for each in copies) or not wanted(self):
            step_itself(self, dt)
        elif half is not None and first.space is None:
            first.begin(self, sys._getframe(1).f_code.co_names)
            step_itself(self, dt)
        elif half is not None and self is first.space and abs(dt - 2 * half) <= 1e-9 * half:
            first.undo()
            raise _Stepped(self, float(dt), ahead=True)
        else:
            raise _Stepped(self, float(dt))

    pymunk.Space.step, pymunk.Space.copy = step, copy
    try:
        yield first
    finally:
        pymunk.Space.step, pymunk.Space.copy = step_itself, copy_itself


def _is_wanted(space: pymunk.Space, module: types.ModuleType, name: str) -> bool:
    """Whether a space that is stepped is the one of this name, in the module or in a function that is running."""
    if not name:
        return True
    if name in vars(module):
        return vars(module)[name] is space
    frame: FrameType | None = sys._getframe(2)
    while frame is not None:
        if frame.f_locals.get(name) is space:
            return True
        frame = frame.f_back
    return False


def _where(path: Path, name: str, stepped: _Stepped) -> tuple[str, int | None]:
    """What a space is called where the script goes on to step it, and the line of that statement.

    Of the functions that are running, the outermost that has a name for it; ("", None) if none has.
    """
    trace: TracebackType | None = stepped.__traceback__
    while trace is not None:
        code = trace.tb_frame.f_code
        names = [word for word, value in trace.tb_frame.f_locals.items() if value is stepped.space]
        if code.co_filename == str(path) and names:
            body = _body(ast.parse(path.read_bytes()), code.co_name, trace.tb_lineno)
            return name if name in names else names[0], _holding(body, trace.tb_lineno)
        trace = trace.tb_next
    return "", None


def _body(tree: ast.Module, function: str, line: int) -> list[ast.stmt]:
    """The statements of the innermost function of this name about a line; of the module if there is none."""
    found = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name == function
        if node.lineno <= line <= (node.end_lineno or line)
    ]
    return max(found, key=lambda node: node.lineno).body if found else tree.body


def _holding(body: list[ast.stmt], line: int) -> int | None:
    return next((each.lineno for each in body if each.lineno <= line <= (each.end_lineno or line)), None)


def _guard(path: Path) -> int | None:
    """The line of `if __name__ == ...` at the end of a script."""
    for statement in ast.parse(path.read_bytes()).body:
        if isinstance(statement, ast.If) and "__name__" in ast.unparse(statement.test):
            return statement.lineno
    return None


def rewritten(path: Path, found: Made, own_step: float, change: Change) -> bytes:
    """The script with these settings, before the first step of its space. Raises Unsupported if the space has no name.

    own_step [s]: by which the space is stepped now. Lines that an earlier call has written go first.
    """
    if not found.name:
        raise refuse("the script", "its space has no name of its own where it is stepped, so no line can change it")
    lines = path.read_text(encoding="utf-8").splitlines()
    before = None if found.line is None else found.line - 1
    marks = [next((i for i, line in enumerate(lines) if line.strip() == mark), None) for mark in (BEGIN, END)]
    earlier = None not in marks
    if earlier:
        begin, end = marks[0] or 0, (marks[1] or 0) + 1
        before = before - (end - begin) if before is not None and before >= end else before
        del lines[begin:end]
    if found.ahead and not earlier:
        raise refuse(
            "the script", "its own lines start half a step ahead of a step of that length: change them by hand"
        )
    options = dict(change.options)
    iterations, bias = options["iterations"], options["bias"]
    if earlier and bias is None:  # what the user has may come from the lines that go
        bias = next(iter({joint.error_bias for joint in found.space.constraints}), None)
    name = "space" if found.function else found.name
    settings = [f"{name}.iterations = {iterations}"]
    if bias is not None:
        settings += [f"for joint in {name}.constraints:", f"    joint.error_bias = {bias!r}"]
    if options["ahead"]:
        settings += start_ahead(name, found.space, change.dt)
    parts = round(own_step * found.parts / change.dt)
    if parts > 1:
        settings += PARTS.format(name=name, parts=parts).splitlines()
    if found.function:
        head = [f"def {found.name}(make={found.name}):", "    space = make()"]
        settings = ["", *head, *(f"    {line}" if line else "" for line in settings), "    return space"]
    before = len(lines) if before is None else before
    indent = "" if before == len(lines) else lines[before][: len(lines[before]) - len(lines[before].lstrip())]
    block = [f"{indent}{line}".rstrip() for line in (BEGIN, *settings, END)]
    return "\n".join([*lines[:before], *block, *lines[before:], ""]).encode()
