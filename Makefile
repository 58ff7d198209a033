# Each target sets up everything that it needs on a machine with Python 3.11 and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/ready

.PHONY: quickstart test test-slow check benchmark clean

quickstart: $(READY)
	$(BIN)/visitlab run configs/quickstart.yaml

test: $(READY)
	$(BIN)/python -m pytest -n 2 -rs

test-slow: $(READY)
	$(BIN)/python -m pytest -m slow

check: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

benchmark: $(READY)
	$(BIN)/python -m benchmarks.simulation
	$(BIN)/python -m benchmarks.recording
	$(BIN)/python -m benchmarks.reading
	$(BIN)/python -m benchmarks.program

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	touch $(READY)

clean:
	rm -rf $(VENV)
