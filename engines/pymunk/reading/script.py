"""Run a script that makes a pymunk space up to the first step, and change the script's settings."""

from __future__ import annotations

import ast
import contextlib
import io
import os
import sys
import traceback
import types
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any

import pymunk

from engines.pymunk.reading.own_model import start_ahead
from engines.reading import Change, refuse

SCRIPT_MODULE = "crosscheck_check"  # the script's __name__
BEGIN, END = "# crosscheck check --apply: these lines are written anew each time", "# crosscheck check --apply: end"
# Modules that a script shares with this process, even if a file in the script's folder has the same name.
SHARED_MODULES = {"pymunk", "builtins", "sys", "os", "__main__"}
STEP_IN_PARTS = '''
def in_parts(dt, step={name}.step, space={name}):
    """Make {parts} equal steps in place of one; the forces and torques set before it act in each of them."""
    pushed = [(body, body.force, body.torque) for body in space.bodies]
    for _ in range(in_parts.parts):
        for body, force, torque in pushed:
            body.force, body.torque = force, torque
        step(dt / in_parts.parts)

in_parts.parts = {parts}
{name}.step = in_parts
'''


@dataclass(frozen=True, eq=False)
class ScriptSpace:
    """The space that a script makes, before its first step.

    `dt` [s]: argument of the script's calls of `space.step`, or None if there are no calls. `parts`: number of steps in
    a call; `rewritten` may divide steps. `line`: settings can be inserted before this line, or None for the end of the
    script. `name`: name of the space at this line, or of the function that makes the space. `ahead`: whether the first
    step is a half step that advances the velocities; the space is then in the state before this step.
    """

    space: pymunk.Space
    dt: float | None
    name: str
    line: int | None
    is_function: bool = False
    parts: int = 1
    ahead: bool = False


class _SpaceStepped(BaseException):
    def __init__(self, space: Any, dt: float, ahead: bool = False) -> None:
        super().__init__("the script steps its space")
        self.space, self.dt, self.ahead = space, dt, ahead


def run_script(path: Path, file: str, name: str) -> ScriptSpace:
    """The space that a script calls `name`, or that a function of this name returns; by default its only space.

    The script ends before it steps the space, and its output is discarded. If joints correct the whole gap, the first
    step may be a half step that advances the velocities. The script is then run again up to the second step. If the
    second step is twice as long, the first step is a half step. Raises ValueError in one line.
    """
    script = _run_script(path, file, name)
    if script.dt is None or not any(joint.error_bias == 0 for joint in script.space.constraints):
        return script
    with contextlib.suppress(ValueError):
        again = _run_script(path, file, name, script.dt)
        if again.ahead:
            return again
    return script


def _run_script(path: Path, file: str, name: str, half: float | None = None) -> ScriptSpace:
    module = types.ModuleType(SCRIPT_MODULE)
    module.__file__ = str(path)
    try:
        with (
            _as_main_script(path, module),
            _stopped_at_step(lambda space: _is_wanted(space, module, name), half) as first,
        ):
            # The space may be in the part of the script that runs only as the main program.
            for module_name in (SCRIPT_MODULE,) if name else (SCRIPT_MODULE, "__main__"):
                module.__dict__["__name__"] = module_name
                with _errors_in_one_line(path, file):
                    exec(compile(path.read_bytes(), str(path), "exec"), module.__dict__)
                if name or _spaces(module) or _main_guard(path) is None:
                    break
            space, name = _value_of(module, file, name)
            is_function = callable(space)
            if is_function:
                with _stopped_at_step(lambda _: True, half) as first, _errors_in_one_line(path, file):
                    space = space()
    except _SpaceStepped as stop:
        return _with_parts(ScriptSpace(stop.space, stop.dt, *_name_and_line(path, name, stop), ahead=stop.ahead))
    if not isinstance(space, pymunk.Space):
        kind = type(space).__name__
        raise ValueError(f"{file}:{name}: it is {kind}; it must be a pymunk.Space, or a function that returns one")
    script = ScriptSpace(space, None, name, _main_guard(path), is_function)
    if half is not None and first.space is space and first.by_lines:
        first.undo()
        script = replace(script, dt=2 * half, ahead=True)
    return _with_parts(script)


def _with_parts(script: ScriptSpace) -> ScriptSpace:
    """Remove an attribute `step` of the space, since it would step the original even in a copy of the space."""
    step = vars(script.space).pop("step", None)
    return replace(script, parts=int(getattr(step, "parts", 1)))


@contextlib.contextmanager
def _errors_in_one_line(path: Path, file: str) -> Iterator[None]:
    try:
        yield
    except _SpaceStepped:
        raise
    except BaseException as error:
        try:
            message = " ".join(str(error).split())
        except Exception:
            message = "(its message can't be printed)"
        frames = traceback.extract_tb(error.__traceback__)
        line = next((f" in line {frame.lineno}" for frame in reversed(frames) if frame.filename == str(path)), "")
        raise ValueError(f"{file} raised {type(error).__name__}{line}{f': {message}' if message else ''}") from None


def _value_of(module: types.ModuleType, file: str, name: str) -> tuple[Any, str]:
    values = vars(module)
    if name:
        if name not in values:
            raise ValueError(f"{file}: it has no {name!r}")
        return values[name], name
    spaces = _spaces(module)
    if len({id(space) for space in spaces.values()}) == 1:
        return next(iter(spaces.values())), next(iter(spaces))
    problem = f"its spaces are {', '.join(spaces)}" if spaces else "it has no space"
    raise ValueError(
        f"{file}: {problem}; give the name of the space, or of a function without arguments that returns one, as in "
        f"{file}:{next(iter(spaces), 'space')}"
    )


def _spaces(module: types.ModuleType) -> dict[str, pymunk.Space]:
    return {name: value for name, value in vars(module).items() if isinstance(value, pymunk.Space)}


@contextlib.contextmanager
def _as_main_script(path: Path, module: types.ModuleType) -> Iterator[None]:
    """Set the working folder, the arguments and the import path as `python script.py` does, and discard the output.

    If a module has the name of a file in the script's folder, it is temporarily removed from sys.modules, so that the
    script imports the file.
    """
    folder, arguments, paths = os.getcwd(), sys.argv, list(sys.path)
    files, packages = path.parent.glob("*.py"), path.parent.glob("*/__init__.py")
    own_modules = {*(file.stem for file in files), *(file.parent.name for file in packages)} - SHARED_MODULES
    hidden = {name: value for name, value in sys.modules.items() if name.partition(".")[0] in own_modules}
    for name in hidden:
        del sys.modules[name]
    sys.modules[SCRIPT_MODULE], sys.argv, sys.path[:] = module, [str(path)], [str(path.parent), *paths]
    try:
        os.chdir(path.parent)
        with contextlib.redirect_stdout(io.StringIO()):
            yield
    finally:
        os.chdir(folder)
        for name in [name for name in sys.modules if name == SCRIPT_MODULE or name.partition(".")[0] in own_modules]:
            del sys.modules[name]
        sys.modules.update(hidden)
        sys.argv, sys.path[:] = arguments, paths


@dataclass
class _FirstStep:
    space: Any = None
    velocities: tuple[tuple[Any, float], ...] = ()
    by_lines: bool = False  # whether the script moves the bodies back, or replaces their position function

    def begin(self, space: Any, names: Sequence[str]) -> None:
        self.space, bodies = space, list(space.bodies)
        self.velocities = tuple((body.velocity, body.angular_velocity) for body in bodies)
        without_drift = any(body._position_func is not None for body in bodies)
        self.by_lines = without_drift or {"position", "angle", "velocity", "angular_velocity"} <= {*names}

    def undo(self) -> None:
        for body, (velocity, rate) in zip(self.space.bodies, self.velocities, strict=True):
            body.velocity, body.angular_velocity = velocity, rate


@contextlib.contextmanager
def _stopped_at_step(is_wanted: Callable[[Any], bool], half: float | None) -> Iterator[_FirstStep]:
    """Make the first step of a wanted space raise _SpaceStepped; copies of the space are stepped.

    With `half`, the second step raises the exception. If the first step is half as long as the second step, it is
    undone.
    """
    original_step, original_copy = pymunk.Space.step, pymunk.Space.copy
    copies: list[pymunk.Space] = []
    first = _FirstStep()

    def copy(self: pymunk.Space) -> pymunk.Space:
        copies.append(original_copy(self))
        return copies[-1]

    def step(self: pymunk.Space, dt: float) -> None:
        if any(self is space for space in copies) or not is_wanted(self):
            original_step(self, dt)
        elif half is not None and first.space is None:
            first.begin(self, sys._getframe(1).f_code.co_names)
            original_step(self, dt)
        elif half is not None and self is first.space and abs(dt - 2 * half) <= 1e-9 * half:
            first.undo()
            raise _SpaceStepped(self, float(dt), ahead=True)
        else:
            raise _SpaceStepped(self, float(dt))

    pymunk.Space.step, pymunk.Space.copy = step, copy
    try:
        yield first
    finally:
        pymunk.Space.step, pymunk.Space.copy = original_step, original_copy


def _is_wanted(space: pymunk.Space, module: types.ModuleType, name: str) -> bool:
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


def _name_and_line(path: Path, name: str, stop: _SpaceStepped) -> tuple[str, int | None]:
    """The name of the space that was stepped, and the line of the statement that steps it.

    The name and line are taken from the outermost function on the call stack that has a name for the space.
    """
    trace: TracebackType | None = stop.__traceback__
    while trace is not None:
        code = trace.tb_frame.f_code
        names = [variable for variable, value in trace.tb_frame.f_locals.items() if value is stop.space]
        if code.co_filename == str(path) and names:
            body = _function_body(ast.parse(path.read_bytes()), code.co_name, trace.tb_lineno)
            return name if name in names else names[0], _statement_line(body, trace.tb_lineno)
        trace = trace.tb_next
    return "", None


def _function_body(tree: ast.Module, function: str, line: int) -> list[ast.stmt]:
    """The statements of the innermost function of this name that contains a line, or else of the module."""
    functions = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name == function
        if node.lineno <= line <= (node.end_lineno or line)
    ]
    return max(functions, key=lambda node: node.lineno).body if functions else tree.body


def _statement_line(body: list[ast.stmt], line: int) -> int | None:
    return next((node.lineno for node in body if node.lineno <= line <= (node.end_lineno or line)), None)


def _main_guard(path: Path) -> int | None:
    ifs = (statement for statement in ast.parse(path.read_bytes()).body if isinstance(statement, ast.If))
    return next((statement.lineno for statement in ifs if "__name__" in ast.unparse(statement.test)), None)


def rewritten(path: Path, script: ScriptSpace, step: float, change: Change) -> bytes:
    """The script with other settings, which are inserted before the first step of the space.

    `step` [s]: current step. Lines that an earlier call inserted are replaced. Raises Unsupported if the space has no
    name, or if the user's lines advance the velocities by half a step.
    """
    if not script.name:
        raise refuse(
            "the script",
            "its space has no name where it is stepped, so no line can be written that changes its settings",
        )
    lines = path.read_text(encoding="utf-8").splitlines()
    insert_at = None if script.line is None else script.line - 1
    marks = [next((i for i, line in enumerate(lines) if line.strip() == mark), None) for mark in (BEGIN, END)]
    has_earlier = None not in marks
    if has_earlier:
        begin, end = marks[0] or 0, (marks[1] or 0) + 1
        insert_at = insert_at - (end - begin) if insert_at is not None and insert_at >= end else insert_at
        del lines[begin:end]
    if script.ahead and not has_earlier:
        raise refuse(
            "the script",
            "its own lines advance the velocities by half a step of the present length; change them by hand",
        )
    settings = _setting_lines(script, step, change, has_earlier)
    insert_at = len(lines) if insert_at is None else insert_at
    following = "" if insert_at == len(lines) else lines[insert_at]
    indent = following[: len(following) - len(following.lstrip())]
    block = [f"{indent}{line}".rstrip() for line in (BEGIN, *settings, END)]
    return "\n".join([*lines[:insert_at], *block, *lines[insert_at:], ""]).encode()


def _setting_lines(script: ScriptSpace, step: float, change: Change, has_earlier: bool) -> list[str]:
    options = dict(change.options)
    bias = options["bias"]
    if has_earlier and bias is None:  # the current error_bias may come from lines that are replaced
        bias = next(iter({joint.error_bias for joint in script.space.constraints}), None)
    name = "space" if script.is_function else script.name
    settings = [f"{name}.iterations = {options['iterations']}"]
    if bias is not None:
        settings += [f"for joint in {name}.constraints:", f"    joint.error_bias = {bias!r}"]
    if options["ahead"]:
        settings += start_ahead(name, script.space, change.dt)
    parts = round(step * script.parts / change.dt)
    if parts > 1:
        settings += STEP_IN_PARTS.format(name=name, parts=parts).splitlines()
    if script.is_function:
        head = [f"def {script.name}(make={script.name}):", "    space = make()"]
        settings = ["", *head, *(f"    {line}" if line else "" for line in settings), "    return space"]
    return settings
