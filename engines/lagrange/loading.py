"""Compile the function of `compiled/run.py` with numba once, and load its machine code in later processes.

The argument types are the same for every mechanism. A file in the cache folder contains the machine code, and llvmlite
loads the file in a few milliseconds, without numba. The name of the file contains a digest of the sources, of the
versions of numba and llvmlite, and of the processor, so code for another processor is not loaded. The file begins with
a digest of its content; if the file is damaged, the function is compiled again. The folder is in NUMBA_CACHE_DIR if
this variable is set. Otherwise the folder is next to the sources, or in the user's cache folder if the installation is
read-only. If several processes need the code, one of them compiles, and the others wait.
"""

from __future__ import annotations

import ctypes
import gc
import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from importlib import import_module, metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from engines.user_cache import cache_folder

SOURCE_FOLDER = Path(__file__).parent
COMPILING_NOTE = "compiling the judge's machine code, once for this installation: up to two minutes"


class ObjectFile(NamedTuple):
    """An object file, the name of its function, and the names of functions of other libraries that it calls."""

    function: str
    calls: tuple[str, ...]
    code: bytes


@cache
def installed() -> bool:
    """Whether numba is there and may compile."""
    return find_spec("numba") is not None and os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")


def is_cold() -> bool:
    """Whether the next compiled run must first be compiled, which may take two minutes."""
    return installed() and read_code() is None


def numpy_seconds() -> float:
    """The CPU time [s] that motions have taken in numpy because the machine code was missing."""
    try:
        return float(sum(map(float, _numpy_record().read_text(encoding="ascii").split())))
    except (OSError, ValueError):
        return 0.0


def add_numpy_seconds(seconds: float) -> None:
    with suppress(OSError), _numpy_record().open("a", encoding="ascii") as record:
        record.write(f"{seconds:.3f}\n")


def _numpy_record() -> Path:
    return code_file().with_suffix(".txt")


@cache
def compiled() -> Callable[..., int]:
    """The function `run` of `compiled/run.py`, without Python's lock during a call. Raises ImportError without numba.

    Arguments: the task, the addresses of the blocks, three whole numbers, and two real numbers.
    """
    machine_code = read_code()
    if machine_code is None:
        with _alone():  # another process may have compiled in the meantime
            machine_code = read_code() or _compile()
    integer, pointer, real = ctypes.c_int64, ctypes.c_void_p, ctypes.c_double
    kinds = (pointer, pointer, integer, *[pointer] * 4, *[integer] * 3, *[real] * 2)
    engine = _load(machine_code)
    function = ctypes.CFUNCTYPE(ctypes.c_int32, *kinds)(engine.get_function_address(machine_code.function))

    def call(*arguments: Any) -> int:
        result, error = integer(), pointer()  # by numba's calling convention; the function raises no exceptions
        function(ctypes.addressof(result), ctypes.addressof(error), *arguments)
        return result.value

    return call


def _compile() -> ObjectFile:
    """Compile the function and store the file, which is complete whenever another process reads it.

    Garbage collection is off during the compilation, since it would take a twelfth of the time.
    """
    run = import_module("engines.lagrange.compiled.run")
    collects = gc.isenabled()
    gc.disable()
    try:
        machine_code = ObjectFile(*run.compile_run())
    finally:
        if collects:
            gc.enable()
    content = f"{machine_code.function} {' '.join(machine_code.calls)}\n".encode() + machine_code.code
    with suppress(OSError), tempfile.NamedTemporaryFile(dir=code_file().parent, delete=False) as file:
        file.write(_digest(content).encode() + b"\n" + content)
        file.close()
        os.replace(file.name, code_file())
    return machine_code


def read_code() -> ObjectFile | None:
    """The machine code for this processor, or None if there is no file or if the file is damaged."""
    try:
        digest, _, content = code_file().read_bytes().partition(b"\n")
    except OSError:
        return None
    if digest.decode("ascii", "replace") != _digest(content):
        return None
    names, _, code = content.partition(b"\n")
    function, *calls = names.decode().split()
    return ObjectFile(function, tuple(calls), code)


@cache
def _load(machine_code: ObjectFile) -> Any:
    """LLVM's engine with the code in memory, which is kept until the process ends."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(jit=True)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    # LLVM itself adds calls, such as memset and sincos, which are not in `calls`. Linux has all of them, and elsewhere
    # numba adds the missing functions. A missing function would end the process.
    if sys.platform != "linux" or not all(map(llvm.address_of_symbol, machine_code.calls)):
        _ = import_module("numba.core.registry").cpu_target.target_context
    engine.add_object_file(llvm.ObjectFileRef.from_data(machine_code.code))
    engine.finalize_object()
    return engine


@contextmanager
def _alone() -> Iterator[None]:
    """Wait until no other process compiles. The system releases the lock of a process that is killed.

    Without file locks each process compiles.
    """
    with ExitStack() as stack:
        with suppress(ImportError, OSError):
            from fcntl import LOCK_EX, flock  # not on Windows

            flock(stack.enter_context(code_file().with_suffix(".lock").open("w")), LOCK_EX)
        yield


@cache
def code_file() -> Path:
    """The file with the machine code, in a folder that exists and is writable."""
    configured = os.environ.get("NUMBA_CACHE_DIR")
    for parent in [Path(configured)] if configured else [SOURCE_FOLDER / "__pycache__", cache_folder()]:
        folder = parent / "lagrange"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
        except OSError:
            continue
        return folder / f"{cache_key()[:16]}.code"
    return Path(_temporary_folder().name) / "judge.code"


@cache
def _temporary_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(ignore_cleanup_errors=True)


@cache
def cache_key() -> str:
    """A digest of the sources, of the versions of the compiler, and of the processor."""
    import llvmlite.binding as llvm

    try:
        features = llvm.get_host_cpu_features().flatten()
    except RuntimeError:  # unknown on some systems
        features = ""
    compiler = f"numba {metadata.version('numba')} llvmlite {metadata.version('llvmlite')}"
    digest = hashlib.sha256(
        " ".join((compiler, llvm.get_process_triple(), llvm.get_host_cpu_name(), features)).encode()
    )
    names = ("records.py", "system.py", "elimination.py", "methods.py", "loading.py")
    for source in (*(SOURCE_FOLDER / name for name in names), *sorted((SOURCE_FOLDER / "compiled").glob("*.py"))):
        digest.update(source.name.encode() + b"\0" + source.read_bytes() + b"\0")
    return digest.hexdigest()


def _digest(content: bytes) -> str:
    return hashlib.sha256(cache_key().encode() + content).hexdigest()
