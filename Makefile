# `make fly` and `make test` set everything up by themselves in .venv; all they need is Python 3.11+, make and git.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
FOR_WORK := $(VENV)/.installed-dev
PYTEST_OPTIONS ?= -n auto --dist loadfile

.PHONY: fly test check format bench picture proto clean

fly: $(INSTALLED)
	$(BIN)/galeway fly ian

test: check
	$(BIN)/pytest $(PYTEST_OPTIONS)

check: $(FOR_WORK)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(FOR_WORK)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# All benchmarks, about twenty minutes, into docs/benchmarks.md; benchmarks/report.py NAME ... for some.
bench: $(FOR_WORK)
	$(BIN)/python benchmarks/report.py

# The README's picture, from the recording that `make fly` leaves; needs a Vulkan driver (see docs/picture.py).
picture: $(FOR_WORK)
	$(BIN)/python docs/picture.py runs/ian/flight.rrd

proto: $(FOR_WORK)
	$(BIN)/python -m grpc_tools.protoc -I. --python_out=. recordings/galeway.proto

$(INSTALLED): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "galeway needs Python 3.11 or newer; try make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(FOR_WORK): $(INSTALLED)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@

clean:
	rm -rf $(VENV) runs build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
