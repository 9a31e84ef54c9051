# `make fly` and `make test` set everything up by themselves in .venv; all they need is Python 3.11+, make and git.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
FOR_WORK := $(VENV)/.installed-dev
# Without its bytecode every process that a test starts would compile galeway anew, half a second each time.
unexport PYTHONDONTWRITEBYTECODE
PYTEST_OPTIONS ?= -n auto --dist loadfile --no-loadscope-reorder

.PHONY: fly test check format bench picture proto fuzz interop foxglove clean

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

# All benchmarks, about twenty-five minutes, into docs/benchmarks.md; benchmarks/report.py NAME ... for some.
bench: $(FOR_WORK)
	$(BIN)/python benchmarks/report.py

# The README's picture, from the recording that `make fly` leaves; needs a Vulkan driver (see docs/viewing.md).
picture: $(INSTALLED)
	$(BIN)/galeway picture runs/ian/flight.rrd --at 8:00 --small -o docs/flight.png

# The messages, their page and the layout that shows them, from recordings/schema.py.
proto: $(FOR_WORK)
	$(BIN)/python -m recordings.proto_text > recordings/galeway.proto
	$(BIN)/python docs/recording_page.py > docs/recording.md
	$(BIN)/python docs/foxglove_layout.py > docs/foxglove_layout.json
	$(BIN)/python -m grpc_tools.protoc -I. --python_out=. recordings/galeway.proto

# More than twelve thousand damaged recordings, in some minutes.
fuzz: $(FOR_WORK)
	GALEWAY_FUZZ_CASES=10000 $(BIN)/pytest tests/recordings/test_fuzz.py -q

# Our recordings read by Foxglove's JavaScript reader; needs node and npm.
interop: $(FOR_WORK)
	$(BIN)/python tests/interop/compare.py

# A recording looked at in Foxglove Studio with our layout; needs node, npm and Chromium. RECORDING=FILE for another,
# of minutes rather than hours.
foxglove: $(FOR_WORK)
	$(BIN)/python tests/interop/look.py $(RECORDING)

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "galeway needs Python 3.11 or newer; try make PYTHON=python3.11")'
	$(PYTHON) -m venv $(VENV)

$(INSTALLED): pyproject.toml | $(BIN)/python
	$(BIN)/pip install --quiet --disable-pip-version-check --editable .
	@touch $@

# All at once, without asking for the first part alone before.
$(FOR_WORK): pyproject.toml | $(BIN)/python
	$(BIN)/pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $(INSTALLED) $@

clean:
	rm -rf $(VENV) runs build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
