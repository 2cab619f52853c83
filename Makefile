# make          lint, types and tests: the same as CI
# make demo     sets up an environment and runs the satellite of the paper
# make test     sets up and runs the tests
# make bench    mbsym against SymPy in one run, as ratios (some minutes)

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready

.PHONY: all lint types test demo bench clean
.DEFAULT_GOAL := all

all: lint types test

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	    { echo "mbsym needs Python 3.11 or newer; try  make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || \
	    { echo "python's venv module is missing (on Debian: apt-get install python3-venv)"; exit 1; }
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@touch $(READY)

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(READY)
	$(BIN)/mypy

test: $(READY)
	$(BIN)/python -m pytest

demo: $(READY)
	$(BIN)/mbsym run systems/satellite.yaml

bench: $(READY)
	$(BIN)/python tests/bench/run.py

clean:
	rm -rf $(VENV) reports build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
