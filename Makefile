# Everything runs in .venv, which is made when it is missing.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RESULTS ?= results
# uv takes a tenth of the time of pip, but does not know the package sources that only pip is configured for; pip stands in.
INSTALL := $(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python --constraint constraints.txt --editable

# The lowest versions of all direct dependencies are tried in an environment of their own, with the tests that use them most.
LOWEST := .venv-lowest
LOWEST_TESTS := tests/adapters/test_contract.py tests/casefile/test_case.py tests/commands/test_command_line.py \
	tests/commands/test_pytest_plugin.py tests/running/test_store.py tests/reports/test_plot_files.py

# Ten cases that show what bodycheck finds: flight, sliding, joints, a closed loop and contact. They take half a minute.
TELLING := intermediate-axis-flip free-brick projectile sliding-brick double-pendulum hinge-friction heavy-top slider-crank \
	block-slides-on-ramp rolling-ball

.PHONY: compile run run-all test lint types types-elsewhere tests coverage lowest slow engines claims benchmarks docs linkcheck site sites screenshots release clean

# Where Python writes no bytecode, every process would parse all modules again. Unchanged modules are not compiled again.
compile: $(VENV)/.installed
	$(BIN)/python -m compileall -q bodycheck reference adapters reports tests

run: compile
	$(BIN)/bodycheck run $(TELLING) --out $(RESULTS)

# All shipped cases.
run-all: compile
	$(BIN)/bodycheck run --out $(RESULTS)

# Types are checked beside the tests, which leave a part of the processors idle.
test: lint compile
	+$(MAKE) --no-print-directory --jobs 2 types tests

lint: $(VENV)/.installed-for-development
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.installed-for-development
	$(BIN)/mypy

# The types as they are on other systems, each of which takes as long as `make types`: what Linux alone has must be guarded.
types-elsewhere: $(VENV)/.installed-for-development
	for system in win32 darwin; do $(BIN)/mypy --platform $$system --cache-dir .mypy_cache/$$system || exit 1; done

# All tests of a file in one process: what they share is made once.
tests: $(VENV)/.installed-for-development compile
	$(BIN)/pytest -n auto --dist loadfile

# All tests, and for each room the share of its lines that they reach in any process. Counting takes half as long again.
coverage: $(VENV)/.installed-for-development compile
	rm -rf build/coverage
	$(BIN)/coverage run -m pytest -n auto --dist loadfile
	$(BIN)/python -m tests.support.coverage_by_room

# The tools of the tests come second, since they have no lowest versions.
lowest: $(VENV)/.installed
	$(BIN)/uv venv --quiet --clear --no-project --python $(BIN)/python $(LOWEST)
	$(BIN)/uv pip install --quiet --python $(LOWEST) --resolution lowest-direct --only-binary :all: --editable '.[all]'
	$(BIN)/uv pip install --quiet --python $(LOWEST) --constraint constraints.txt hypothesis jsonschema pytest pytest-xdist pyyaml sympy
	$(LOWEST)/bin/pytest -n auto --dist loadfile $(LOWEST_TESTS)

# Numbers of attacks and their first seed, such as FILES=1000, are in CONTRIBUTING.md. A process that is done takes over
# tests of another, as some take much longer than most.
export FILES RUNS FOLDERS KILLS MECHANISMS TREES DRIVEN SENSORS CONTACTS IMPACTS GRIPS SEED
slow: $(VENV)/.installed-for-development
	$(BIN)/pytest -n auto --dist worksteal -m slow

# Installs every engine that has an adapter in an environment of its own, and tests the adapters there. ENGINES="dart or drake"
# does so for these alone.
engines: $(VENV)/.installed-for-development
	$(BIN)/pytest -m engines -v -k "$(or $(ENGINES),engine or releases)"

# Measures every claim about an engine again, by its command and by its script. ENGINES="dart or drake" does so for these alone.
claims: $(VENV)/.installed-for-development
	$(BIN)/pytest -m claims -v -k "$(or $(ENGINES),claim)"

# Adds a line to benchmarks/speed.jsonl and compares it with the last one of this machine. The other benchmarks are called one by one.
benchmarks: $(VENV)/.installed-for-development compile
	$(BIN)/python benchmarks/speed.py

# A warning is an error, and a name that leads nowhere a warning. Notebooks are executed.
SPHINX = $(BIN)/sphinx-build --quiet --fresh-env --fail-on-warning --keep-going --nitpicky --jobs auto --doctree-dir build/doctrees
docs: $(VENV)/.installed-for-development
	$(SPHINX) --builder html docs build/docs

# Asks every address that a page names, which needs the network. Notebooks are not executed, and so their language is not known.
linkcheck: $(VENV)/.installed-for-development
	$(SPHINX) --define nb_execution_mode=off --define suppress_warnings=myst-nb.lexer --builder linkcheck docs build/linkcheck

# The public site of results, from the submissions of this repository.
site: $(VENV)/.installed
	$(BIN)/bodycheck site submissions --out build/site

# Both sites side by side, as they are published.
sites: docs site
	rm -rf build/sites
	mkdir -p build/sites
	cp .github/pages/index.html build/sites/
	cp -r build/docs build/sites/docs
	cp -r build/site build/sites/results

# Distributions of the last commit in dist/, checked, installed and tried by each of these interpreters, the first with the tutorial.
INTERPRETERS ?= $(BIN)/python
release: $(VENV)/.installed-for-development
	$(BIN)/python -m distribution.release --try $(INTERPRETERS)

screenshots: $(VENV)/.installed-for-development run-all
	$(BIN)/python docs/screenshots.py $(RESULTS)/report.html --out $(RESULTS)/screenshots

$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit("bodycheck needs Python 3.11 or newer, this is " + sys.version) if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --constraint constraints.txt uv
	$(INSTALL) '.[all]' || $(BIN)/pip install --quiet --constraint constraints.txt --editable '.[all]'
	touch $@

$(VENV)/.installed-for-development: $(VENV)/.installed
	$(INSTALL) '.[all,test,lint,docs]' || $(BIN)/pip install --quiet --constraint constraints.txt --editable '.[all,test,lint,docs]'
	touch $@

clean:
	rm -rf $(VENV) $(LOWEST) build dist $(RESULTS)
