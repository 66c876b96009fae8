# Everything from a fresh checkout: environment, install, run.
PYTHON ?= python3
BIN := .venv/bin
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check
# A worker of pytest for each processor, with one thread each. A file stays in one worker, so that what its tests share
# is made once; tests/conftest.py says which files begin. The grid has a pool of its own, and runs after the others.
WORKERS := -n auto --dist loadfile --no-loadscope-reorder
export OMP_NUM_THREADS ?= 1
# The tests start many programs, each of which would compile every module again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: report test publish slow check bench mutants search lower clean

report: .venv/installed          ## run the whole grid, and write pages and charts; all below ./crosscheck-results
	$(BIN)/crosscheck run --full
	$(BIN)/crosscheck report

test: .venv/installed            ## the tests without those marked slow, then the crosscheck grid; red if either is
	$(BIN)/python -m pytest $(WORKERS) -m "not slow and not crosscheck"; tests=$$?; \
	$(BIN)/python -m pytest -m "crosscheck and not slow" && exit $$tests

publish: .venv/installed-mjx     ## for maintainers: all engines and releases, into reports/results and README.md
	$(BIN)/crosscheck run --full
	$(BIN)/crosscheck versions --all --publish
	$(BIN)/crosscheck search --published
	$(BIN)/crosscheck report --publish

slow: .venv/installed            ## the tests that take minutes each: all bad arguments, 200 kills, every wrong model
	$(BIN)/python -m pytest $(WORKERS) -m slow

check: .venv/installed-develop   ## style, types, layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/lint-imports

bench: .venv/installed-bench     ## what stepping costs beside the bare loops, and the site
	$(BIN)/crosscheck site
	$(BIN)/crosscheck bench
	$(BIN)/crosscheck bench site

mutants: .venv/installed         ## deliberate mistakes, and which the tests let through; ONLY=engines/pymunk for some
	$(BIN)/python -m tests.tools.mutants $(ONLY)

SECONDS ?= 600
search: .venv/installed          ## mechanisms that were never asked about, in all engines, for SECONDS; each finding with its seed
	$(BIN)/crosscheck search --fresh --seconds $(SECONDS)

lower: .venv-lower/installed     ## the tests, without the grid, with the oldest versions of everything that pyproject.toml allows
	.venv-lower/bin/python -m pytest $(WORKERS) -m "not crosscheck and not slow"

.venv-lower/installed: pyproject.toml
	$(PYTHON) -m venv .venv-lower
	$(PYTHON) tests/tools/lower_bounds.py > .venv-lower/constraints.txt
	.venv-lower/bin/python -m pip install --quiet --disable-pip-version-check --constraint .venv-lower/constraints.txt --editable ".[test]"
	touch $@

.venv/installed: pyproject.toml
	$(PYTHON) -m venv .venv
	$(PIP) --editable ".[test]"
	touch $@

.venv/installed-%: .venv/installed
	$(PIP) --prefer-binary --editable ".[test,$*]"
	touch $@

# All engines: a part of MJX has to be installed by itself (engines/mjx.py).
.venv/installed-mjx: .venv/installed-engines
	$(PIP) --no-deps mujoco-mjx
	touch $@

clean:
	rm -rf .venv .venv-lower .venv-all build
