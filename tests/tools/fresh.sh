#!/usr/bin/env bash
# README as it is met by somebody who has nothing of it yet: its commands in a clone of the last commit, in new
# environments, with empty caches and an empty home. tests/tools/fresh.sh [PART ...]; without a part, all but `test`, `lower`:
#   readme   what stands in README as a command or as Python, with `pip install .` alone; numba is not there
#   pythons  each Python from 3.11 to 3.14: everything is imported, a scene is run, first without numba and then with it
#   wheel    `pip wheel .`, installed and run in another folder
#   report   `make report`; it changes nothing that git tracks
#   test     `make test`
#   lower    `make lower`, the oldest versions of everything
# PYTHON (python3) makes the environments of all parts but `pythons`. Status 1 if a step failed; all steps are tried.
set -uo pipefail
tree=$(cd "$(dirname "$0")/../.." && pwd)
python=$(command -v "${PYTHON:-python3}")
work=$(mktemp -d "${TMPDIR:-/tmp}/fresh.XXXXXX")
mkdir -p "$work/home" "$work/elsewhere"
export HOME=$work/home XDG_CACHE_HOME=$work/cache NUMBA_CACHE_DIR=$work/numba PYTHON=$python OMP_NUM_THREADS=1
export PIP_DISABLE_PIP_VERSION_CHECK=1
unset PYTHONPATH VIRTUAL_ENV PYTHONDONTWRITEBYTECODE
git clone --quiet "$tree" "$work/clone" && cd "$work/clone" || exit 1
failed=0

step() {  # step WORDS COMMAND ...: one line with the outcome, and of a failure the end of what was said
  local words=$1 status=0 log=$work/log spent=$work/spent
  shift
  TIMEFORMAT="%0R s wall, %0U + %0S s of processors"
  { time "$@" < /dev/null > "$log" 2>&1; } 2> "$spent" || status=$?
  echo "$([ $status = 0 ] && echo ok || echo "FAILED, status $status"): $words ($(tail -n 1 "$spent"))"
  grep -E '^(=+ )?[0-9]+ (passed|failed|skipped|deselected).* in [0-9.]+s' "$log" | sed 's/^/    /'
  [ $status = 0 ] || { failed=1 && tail -n 15 "$log" | sed 's/^/    /'; }
}

environment() {  # environment FOLDER WHAT ...: a new one, with what pip is told to install
  "${maker:-$python}" -m venv "$1" && "$1/bin/python" -m pip install --quiet "${@:2}"
}

clean() { [ -z "$(git status --porcelain)" ]; }

import_all() {  # import every module of ours in a folder's environment
  "$1/bin/python" - << 'END'
import importlib
import pkgutil

for package in ("reference", "engines", "reports"):
    for module in pkgutil.walk_packages([str(importlib.import_module(package).__path__[0])], f"{package}."):
        if ".programs" in module.name:
            continue
        try:
            importlib.import_module(module.name)
        except ModuleNotFoundError as missing:
            if missing.name not in ("numba", "pytest"):  # extras of development
                raise
END
}

part_readme() {
  step "pip install ." environment "$work/plain" .
  export PATH=$work/plain/bin:$PATH
  step "numba is not there" sh -c '! python -c "import numba"'
  awk '/^```/ { inside = !inside && $0 == "```"; next } inside && /^crosscheck/' README.md > "$work/commands"
  while read -r line; do step "$(echo ${line%% \#*})" sh -c "$line"; done < "$work/commands"
  awk '/^```/ { inside = $0 == "```python"; next } inside' README.md > "$work/example.py"
  step "README's Python" python "$work/example.py"
  step "crosscheck errata" crosscheck errata
  step "crosscheck conform engines.pymunk:TUNED" crosscheck conform engines.pymunk:TUNED
  step "crosscheck export" sh -c "crosscheck export free_four_bar --to mjcf --variant tuned > $work/model.xml"
  step "crosscheck check model.xml" crosscheck check "$work/model.xml"
  step "crosscheck search --seconds 10" crosscheck search --seconds 10
  step "a wheel of MuJoCo" pip download --quiet --no-deps --dest "$work/dist" mujoco-core==4.0.1
  step "crosscheck compare" sh -c "crosscheck compare mujoco==4.0.1 $work/dist/*.whl"
  step "nothing that git tracks has changed" clean
}

part_pythons() {
  local maker version place
  for version in 3.11 3.12 3.13 3.14; do
    maker=$(command -v "python$version")
    "${maker:-false}" -c "" 2> /dev/null || { echo "missing: python$version is not on the path" && continue; }
    place=$work/python$version
    step "Python $version: pip install ." environment "$place" .
    step "Python $version: everything is imported, without numba" import_all "$place"
    step "Python $version: a scene is run" "$place/bin/crosscheck" run free_four_bar --quick --results "$place/results"
    step "Python $version: its pages" "$place/bin/crosscheck" report --results "$place/results"
    step "Python $version: .[test], with numba" "$place/bin/python" -m pip install --quiet --editable ".[test]"
    step "Python $version: the same cells with numba" "$place/bin/crosscheck" run free_four_bar --quick --fresh --results "$place/results"
    step "Python $version: some tests" "$place/bin/python" -m pytest -q -m "not slow and not crosscheck" \
      tests/reference/test_mechanism.py tests/engines/test_lagrange.py
    step "Python $version: the grid of a scene" "$place/bin/python" -m pytest -q -m crosscheck --scene free_four_bar
  done
}

part_wheel() {
  step "pip wheel ." "$python" -m pip wheel --quiet --no-deps --wheel-dir "$work/wheels" .
  step "the wheel is installed" environment "$work/installed" "$work"/wheels/*.whl
  cd "$work/elsewhere" || return
  step "a scene is run in another folder" "$work/installed/bin/crosscheck" run free_four_bar --quick
  step "its pages" "$work/installed/bin/crosscheck" report
  step "it asks an engine its questions" "$work/installed/bin/crosscheck" conform engines.mujoco:TUNED
  cd "$work/clone" || return
}

part_report() {
  step "make report" make report
  step "index.md is there, and nothing that git tracks has changed" sh -c \
    '[ -s crosscheck-results/index.md ] && [ -z "$(git status --porcelain)" ]'
}

part_test() { step "make test" make test; }
part_lower() { step "make lower" make lower; }

for part in "${@:-readme pythons wheel report}"; do
  for each in $part; do "part_$each"; done
done
rm -rf "$work"
exit $failed
