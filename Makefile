# Everything from a fresh checkout: environment, install, run.
PYTHON ?= python3
BIN := .venv/bin
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check
# pytest has a worker with one thread for each processor. The tests of a file run in the same worker and share fixtures.
# tests/conftest.py lists the files that start first. The grid has its own pool and runs after the tests.
WORKERS := -n auto --dist loadfile --no-loadscope-reorder
export OMP_NUM_THREADS ?= 1
# The tests start many programs. Without stored bytecode, each program would compile every module.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: report test publish slow check bench mutants search lower clean

report: .venv/installed          ## run all cells that pages print, and write pages and charts; all below ./crosscheck-results
	$(BIN)/crosscheck run --pages
	$(BIN)/crosscheck report

test: .venv/installed            ## the tests without those marked slow, then the crosscheck grid; red if either is
	$(BIN)/python -m pytest $(WORKERS) -m "not slow and not crosscheck"; tests=$$?; \
	$(BIN)/python -m pytest -m "crosscheck and not slow" && exit $$tests

publish: .venv/installed-mjx     ## for maintainers: all engines and releases, into reports/results and README.md
	$(BIN)/python -m engines.browser
	$(BIN)/python -m reports.site.munk2d
	$(BIN)/crosscheck run --full
	$(BIN)/crosscheck versions --all --publish
	$(BIN)/crosscheck search --published
	$(BIN)/crosscheck report --publish

slow: .venv/installed            ## the tests that take minutes each, such as 200 killed workers and every wrong model
	$(BIN)/python -m pytest $(WORKERS) -m slow

check: .venv/installed-develop   ## style, types, layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/lint-imports

bench: .venv/installed-bench     ## CPU time of stepping compared with plain loops, and the site in a browser
	$(BIN)/crosscheck site
	$(BIN)/crosscheck bench
	$(BIN)/crosscheck bench site

mutants: .venv/installed         ## apply deliberate mistakes and list those that no test detects; ONLY=engines/pymunk selects by path
	$(BIN)/python -m tests.tools.mutants $(ONLY)

SECONDS ?= 600
search: .venv/installed          ## random mechanisms from new seeds in all engines, for SECONDS; each finding has its seed
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

# All engines; mujoco-mjx is installed without its dependencies (engines/mjx.py).
.venv/installed-mjx: .venv/installed-engines
	$(PIP) --no-deps mujoco-mjx
	touch $@

clean:
	rm -rf .venv .venv-lower .venv-all build
