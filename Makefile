# Each target sets up everything that it needs on a machine with Python 3.11 or newer and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/ready
LOWEST := .venv-lowest

.PHONY: quickstart test warm test-slow test-lowest faults faults-fast check benchmark clean

quickstart: $(READY)
	$(BIN)/visitlab run configs/quickstart.yaml

test: $(READY)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n 3 --dist loadfile -rs

# Compiles, into the cache of compiled code, what most tests need; they work without it.
warm: $(READY)
	runs=$$(mktemp -d) && $(BIN)/visitlab run tests/tiny.yaml --out $$runs --workers 1 --quiet && rm -r $$runs

test-slow: $(READY)
	VISITLAB_TESTS_WITHOUT_FORKS=1 $(BIN)/python -m pytest -m slow

# The lowest versions that pyproject.toml declares, in an environment of their own: by hand, before a release.
test-lowest:
	rm -rf $(LOWEST)
	$(PYTHON) -m venv $(LOWEST)
	$(PYTHON) tests/lowest.py > $(LOWEST)/lowest.txt
	$(LOWEST)/bin/python -m pip install --quiet --constraint $(LOWEST)/lowest.txt --editable '.[dev]'
	VISITLAB_TESTS_WITHOUT_FORKS=1 $(LOWEST)/bin/python -m pytest -n 2

# What goes wrong around a run, done for real; FAULTS='killed --seed 7' chooses.
faults: $(READY)
	$(BIN)/python -m tests.faults $(FAULTS)

# A slice of it, for CI.
faults-fast: $(READY)
	$(BIN)/python -m tests.faults --fast

check: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

benchmark: $(READY)
	$(BIN)/python -m benchmarks --page docs/performance.md

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	touch $(READY)

clean:
	rm -rf $(VENV) $(LOWEST)
