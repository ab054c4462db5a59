# Everything runs in .venv, which is made when it is missing.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RESULTS ?= results

.PHONY: run test lint types tests slow benchmarks screenshots clean

run: $(VENV)/.installed
	$(BIN)/bodycheck run --out $(RESULTS)

test: lint types tests

lint: $(VENV)/.installed-for-development
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.installed-for-development
	$(BIN)/mypy

# All tests of a file in one process: what they share is made once.
tests: $(VENV)/.installed-for-development
	$(BIN)/pytest -n auto --dist loadfile

# Numbers of attacks and their first seed, such as FILES=1000, are in CONTRIBUTING.md. A process that is done takes over
# tests of another, as some take much longer than most.
export FILES RUNS FOLDERS KILLS SEED
slow: $(VENV)/.installed-for-development
	$(BIN)/pytest -n auto --dist worksteal -m slow

benchmarks: $(VENV)/.installed-for-development
	for benchmark in benchmarks/*.py; do $(BIN)/python $$benchmark || exit 1; done

screenshots: $(VENV)/.installed-for-development run
	$(BIN)/python docs/screenshots.py $(RESULTS)/report.html --out $(RESULTS)/screenshots

$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; sys.exit("bodycheck needs Python 3.11 or newer, this is " + sys.version) if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --constraint constraints.txt --editable .
	touch $@

$(VENV)/.installed-for-development: $(VENV)/.installed
	$(BIN)/pip install --quiet --constraint constraints.txt --editable '.[test,lint]'
	touch $@

clean:
	rm -rf $(VENV) build $(RESULTS)
