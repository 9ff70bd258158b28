# One line for each target: `make help`. On a fresh machine: Python 3.11 or later, make, a C compiler.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
JOBS   ?= 2

.PHONY: help setup regenerate check test test-all bench docs site clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 14

setup: $(STAMP)  ## make .venv and install coadjoint in it, with what its tests need

$(STAMP): pyproject.toml setup.py
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or later is needed; name one: make PYTHON=python3.12")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -P -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $(STAMP)

regenerate: setup  ## derive, prove, check and write all systems into generated/
	$(BIN)/coadjoint regenerate

check: setup  ## lint, types and specs
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/tombi lint --offline --quiet derivations

test: setup  ## run the tests; campaigns, and long cases of tests with shorter ones, are left out
	$(BIN)/python -P -m pytest -q -n $(JOBS) --dist worksteal -m "not campaign and not long"

test-all: setup  ## run all tests
	$(BIN)/python -P -m pytest -q -n $(JOBS) --dist worksteal

bench: setup  ## measure every figure; a peer that is not installed is a line that says so
	$(BIN)/python benchmarks/run.py

docs: regenerate  ## write docs/specs.md, docs/pictures, and build/docs with schema and derivations
	$(BIN)/python -P docs/make.py

site: setup  ## build the site into build/site: documents, gallery, explorers, reference
	$(BIN)/python -P -m pip install --quiet --disable-pip-version-check --editable '.[site]'
	$(BIN)/python -P site/build.py

clean:  ## remove what was built; .venv, and whatever git ignores below it, go too
	rm -rf build dist $(VENV) .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
	rm -rf *.egg-info src/*.egg-info
