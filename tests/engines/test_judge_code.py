"""The file with the judge's machine code: damage, other processors, several processes, and starts without numba."""

from __future__ import annotations

import copy
import pickle
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from engines.lagrange import TRUTH, Lagrange, loading
from engines.lagrange.compiled_model import CompiledModel
from engines.lagrange.methods import RK4
from engines.lagrange.records import block_of
from tests.mechanisms import four_bar

pytestmark = pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")

MECHANISM = """
from reference.linkage import linkage
points = {"A": (0, 0), "B": (0, 0.3), "C": (0.8, 0.6), "D": (0.7, 0)}
mechanism = linkage(points, {"crank": "AB", "coupler": "BC", "rocker": "DC"}, ground="AD")
"""
MOTION = f"""
import sys
from engines.lagrange import TRUTH, Lagrange
{MECHANISM}
runs = [engine.build(mechanism, 0.01)(20, 1) for engine in (TRUTH, Lagrange("rk4", "baumgarte"))]
bits = [array.tobytes().hex() for run in runs for array in (run.pose, run.twist, run.reaction)]
print(*bits, file=sys.stderr)
"""


@pytest.fixture
def copied_code(monkeypatch, tmp_path):
    """The path of a copy of the machine code, which `loading` uses instead of the file in the cache folder."""
    loading.compiled()
    copy = tmp_path / "judge.code"
    shutil.copy(loading.code_file(), copy)
    monkeypatch.setattr(loading, "code_file", lambda: copy)
    assert not loading.is_cold()
    return copy


def run_python(program: str) -> tuple[str, str]:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return done.stdout, done.stderr


@pytest.mark.parametrize("place", [0, 70, -1])
def test_a_damaged_file_is_not_loaded(copied_code, place):
    content = bytearray(copied_code.read_bytes())
    content[place] ^= 1
    copied_code.write_bytes(content)
    assert loading.is_cold()


def test_an_incomplete_file_is_not_loaded(copied_code):
    content = copied_code.read_bytes()
    for count in (0, 10, 64, 65, len(content) // 2, len(content) - 1):
        copied_code.write_bytes(content[:count])
        assert loading.is_cold()


def test_code_for_another_processor_is_not_loaded(copied_code, monkeypatch):
    own_key = loading.cache_key()
    loading.cache_key.cache_clear()
    try:
        monkeypatch.setattr("llvmlite.binding.get_host_cpu_name", lambda: "another")
        assert loading.cache_key() != own_key
        assert loading.is_cold()  # even if the file of another processor has the name of this one
    finally:
        loading.cache_key.cache_clear()


def test_damaged_code_is_compiled_and_stored_again(copied_code, monkeypatch):
    expected = loading.read_code()
    compile_module = type("Module", (), {"compile_run": staticmethod(lambda: expected)})
    monkeypatch.setattr(loading, "import_module", lambda name: compile_module)
    copied_code.write_bytes(b"damaged")
    loading.compiled.__wrapped__()
    assert loading.read_code() == expected
    assert {path.name for path in copied_code.parent.iterdir()} == {"judge.code", "judge.lock"}


def test_one_process_compiles_while_the_others_wait(copied_code):
    fcntl = pytest.importorskip("fcntl")
    content = copied_code.read_bytes()
    copied_code.unlink()
    program = f"""
from pathlib import Path
from engines.lagrange import loading
loading.code_file = lambda: Path({str(copied_code)!r})
def refuse(): raise SystemExit("compiled although another process compiles")
loading._compile = refuse
print("begin", flush=True)
loading.compiled()
"""
    with copied_code.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as other:
            assert other.stdout is not None
            assert other.stdout.readline() == b"begin\n"
            with pytest.raises(subprocess.TimeoutExpired):
                other.wait(0.5)
            copied_code.write_bytes(content)
            fcntl.flock(lock, fcntl.LOCK_UN)
            assert other.wait() == 0


def test_a_run_with_stored_code_imports_neither_numba_nor_slow_parts_of_scipy():
    loading.compiled()
    slow = "{'numba', 'scipy.integrate', 'scipy.sparse', 'scipy.linalg', 'scipy.special'} & {*sys.modules}"
    out, _ = run_python(f"{MOTION}\nprint({slow})")
    assert out.strip() == "set()"


def test_stored_code_gives_the_same_bits_with_and_without_numba():
    """numba defines mathematical functions for machine code, which are the same as those of the process."""
    loading.compiled()
    _, with_numba = run_python(f"import numba; numba.njit(lambda x: x ** 0.3)(2.0)\n{MOTION}")
    _, without = run_python(MOTION)
    assert with_numba == without != ""


def test_without_numba_a_run_is_computed_in_numpy(monkeypatch):
    monkeypatch.setattr(loading, "find_spec", lambda name: None)
    loading.installed.cache_clear()
    try:
        assert not Lagrange().in_machine_code
        monkeypatch.setattr(loading, "compiled", lambda: pytest.fail("machine code is used without numba"))
        run = Lagrange().build(four_bar(), 1e-3)(2, 1)
    finally:
        monkeypatch.undo()
        loading.installed.cache_clear()
    np.testing.assert_array_equal(run.pose, Lagrange(compiled=False).build(four_bar(), 1e-3)(2, 1).pose)


def test_building_a_run_compiles_nothing(monkeypatch):
    monkeypatch.setattr("engines.lagrange.compiled_model.compiled", lambda: pytest.fail("a build compiles"))
    monkeypatch.setattr("engines.lagrange.engine.compiled", lambda: pytest.fail("a build compiles"))
    TRUTH.build(four_bar(), 0.01)


@pytest.mark.parametrize("kind", [np.float32, np.int64, ">f8"])
def test_numbers_of_another_type_do_not_reach_machine_code(kind):
    tableau = RK4._replace(weights=RK4.weights.astype(kind))
    with pytest.raises(TypeError, match=f"has the type {np.dtype(kind)}; convert its numbers to float64"):
        block_of(tableau)


@pytest.mark.parametrize("make_copy", [copy.copy, copy.deepcopy, lambda model: pickle.loads(pickle.dumps(model))])
def test_a_copy_of_a_model_uses_its_own_arrays(make_copy):
    model = CompiledModel.of(four_bar())
    assert model is not None
    duplicate = make_copy(model)
    assert list(duplicate._system_block) == list(block_of(duplicate.system))
    assert list(duplicate._storage_block) == list(block_of(duplicate.storage))
    for each in (model, duplicate):
        poses, twists = each.empty_samples(3)
        assert each.fixed_steps(RK4, 1, 1e-3, 1, 0, poses, twists) == 3
        np.testing.assert_array_equal(poses, Lagrange("rk4").build(four_bar(), 1e-3)(3, 1).pose)


def test_outside_linux_numba_adds_the_functions_that_llvm_calls(monkeypatch):
    stored, imported = loading.ObjectFile(*loading.read_code() or loading._compile()), []

    def import_it(name):
        imported.append(name)
        return SimpleNamespace(cpu_target=SimpleNamespace(target_context=None))

    monkeypatch.setattr(loading, "import_module", import_it)
    for platform, names in (("linux", []), ("win32", ["numba.core.registry"]), ("darwin", ["numba.core.registry"])):
        imported.clear()
        monkeypatch.setattr(loading.sys, "platform", platform)
        loading._load.__wrapped__(stored)
        assert imported == names


def test_the_key_of_machine_code_depends_on_every_layout_of_a_block(monkeypatch):
    """Otherwise a new member of a block would be read by old code."""
    read, names = Path.read_bytes, set()
    monkeypatch.setattr(Path, "read_bytes", lambda path: names.add(path.name) or read(path))
    loading.cache_key.__wrapped__()
    assert {"records.py", "methods.py", "system.py", "elimination.py", "run.py"} <= names
