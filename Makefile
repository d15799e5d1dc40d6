# make demo   sets everything up and runs the main job on the embedded animals
# make test   sets everything up and runs the tests
# make coverage   sets everything up, runs the tests, and reports the lines and branches that they do not reach
# make integrations   sets everything up and tests the add-ons in those programs that are installed
# make audit   sets everything up and looks at the licences of what it depends on, and for known advisories
# make baselines   trains the benchmark's methods for a release, in half an hour
# make release   builds everything that is published into dist/, and tests each piece
# make docs   sets everything up and builds the documentation into site/index.html
VENV ?= .venv
BIN := $(VENV)/bin
RUN := runs/quickstart
# Python keeps what it has compiled, also where it is told not to: the tests start it some hundred times over, and each
# of their processes would rewrite the asserts of all tests anew.
export PYTHONDONTWRITEBYTECODE :=
# As many processes as cores, but no more than four: each needs 1.5 GB. A file's tests share fixtures, so they stay together.
PYTEST := $(BIN)/pytest --numprocesses=logical --maxprocesses=4 --dist=loadfile --no-loadscope-reorder --durations=10

.PHONY: help install dev demo test integrations processors coverage audit docs baselines release lint types clean
help:
	@sed -n 's/^# \(make .*\)/\1/p' Makefile

install: $(VENV)/.installed
dev: $(VENV)/.installed-dev

$(VENV)/.installed: pyproject.toml tools/install.sh
	tools/install.sh $(VENV) '[train]'
	@touch $@

$(VENV)/.installed-dev: pyproject.toml tools/install.sh
	tools/install.sh $(VENV) '[dev]'
	@touch $@ $(VENV)/.installed

# The demo's own folder is made anew; no other run is touched.
demo: install
	rm -rf $(RUN)
	$(BIN)/normalgan fit --config configs/quickstart.yaml
	$(BIN)/normalgan test --config configs/quickstart.yaml --ckpt_path $(RUN)/checkpoints/last.ckpt
	$(BIN)/normalgan predict --config configs/quickstart.yaml --ckpt_path $(RUN)/checkpoints/last.ckpt
	$(BIN)/python tools/demo_picture.py $(RUN) examples/sketches

# make test SLOW=1 also runs the tests that take long; TESTS=tests/metrics runs a part.
test: dev
	$(PYTEST) $(if $(SLOW),,-m "not slow") $(TESTS)

# One after the other: programs with windows wait long for a busy core.
integrations: dev
	$(BIN)/pytest --durations=10 tests/integrations

# Doctests and numeric tests as on other processors, where the last bits of results differ: nothing may depend on them.
processors: dev
	tools/check_processors.sh $(BIN)/python

# A report, no threshold: to find what has no test. TESTS=tests/metrics looks at a part, SLOW=1 runs all.
coverage: dev
	mkdir -p build/coverage
	$(PYTEST) --cov --cov-report=term --cov-report=html $(if $(SLOW),,-m "not slow") $(TESTS)

# Warnings are errors. The variable silences an advertisement that the theme prints.
docs: dev
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build

baselines: install
	tools/baselines.sh build/baselines $(BIN)/python

# TORCH=torch==2.13.0 takes that version from pip's usual index.
release: docs
	tools/release.sh dist $(BIN)/python

# Apart from the rest: what is known of a package changes without a change here, and may not be reached at all.
audit: dev
	$(BIN)/pip install --quiet 'pip-audit>=2.7' || echo "pip-audit cannot be installed here."
	$(BIN)/python tools/audit.py

lint: dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check

types: dev
	$(BIN)/mypy
	tools/page/check.sh

clean:
	rm -rf $(VENV) runs cache site .mypy_cache .ruff_cache .pytest_cache
