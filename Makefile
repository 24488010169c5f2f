# Needs GNU make, git and a Python 3.11 or newer; everything else is installed into .venv.
#
#   make env PYTHON=python3.12         another interpreter than the first suitable one found
#   make test PYTEST_ARGS='-x -k disc' pytest arguments; by default two processes, with one group of modules after the other

PYTHON      ?=
PYTEST_ARGS ?= -n 2 --dist loadfile
MUTANTS     ?= --count 200

STUDIES := pages overview amplitude_map uncertain_load wear_against_edge_stress coating_window life real_gradients

VENV   := .venv
LOWEST := .venv-lowest
NEWEST := .venv-newest
LOCK   := .venv-lock
DOCS   := .venv-docs

RUN := $(VENV)/bin/python -m
PIP := -m pip --disable-pip-version-check --no-input --quiet

.DEFAULT_GOAL := help
.PHONY: help env test test-compiled test-long test-faults test-mutants test-lowest test-newest test-isa accuracy bench lint format design studies figures numbers words docs notebooks lock clean

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "%-12s %s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))

env: $(VENV)/.stamp ## the environment .venv: pinned dependencies, this package in editable form

test: env ## the default test suite
	$(RUN) pytest $(PYTEST_ARGS)

test-compiled: env ## the tests that wait for the compiler most of their time; some minutes
	$(RUN) pytest -m 'compiled and not long' $(PYTEST_ARGS)

test-long: env ## the long checks: the hunt for the worst point, accuracy at 20000 points a row; about an hour
	XLA_FLAGS= HYPOTHESIS_PROFILE=long $(RUN) pytest tests/fretting/test_accuracy.py -k no_point
	XLA_FLAGS= $(RUN) pytest -m long

test-faults: env ## sweeps that are killed, run out of disk, lose workers or get eight devices; some minutes
	$(RUN) pytest -m faults

test-mutants: env ## errors planted in the mechanics, which the default tests have to notice; hours (MUTANTS='--quick --count 40')
	$(VENV)/bin/python tools/mutants.py $(MUTANTS)

# Old releases may well use what newer ones of their own dependencies deprecate: only that is forgiven here.
test-lowest: $(LOWEST)/.stamp ## the default test suite on the lowest declared versions (Python 3.11 or 3.12)
	$(LOWEST)/bin/python -m pytest -W ignore::DeprecationWarning -W ignore::PendingDeprecationWarning $(PYTEST_ARGS)

test-newest: $(NEWEST)/.stamp ## the default test suite on the newest versions, as `pip install` takes them
	$(NEWEST)/bin/python -m pytest -W ignore::DeprecationWarning -W ignore::PendingDeprecationWarning $(PYTEST_ARGS)

# Rounding differs: without AVX-512 vectors are shorter, and without AVX2 nothing is multiplied and added at once. Where a
# processor does not know a set, XLA uses what there is.
test-isa: env ## the default test suite as on processors with AVX2 and with AVX alone
	XLA_FLAGS=--xla_cpu_max_isa=AVX2 $(RUN) pytest $(PYTEST_ARGS)
	XLA_FLAGS=--xla_cpu_max_isa=AVX $(RUN) pytest $(PYTEST_ARGS)

accuracy: env ## the worst error of every quantity against the reference implementation, as a table
	XLA_FLAGS= $(RUN) pytest -q -s -m long tests/fretting/test_accuracy.py -k 20000 $(PYTEST_ARGS)

bench: env ## time against accuracy, on this machine, into build/benchmarks (BENCH=--full to quote, into docs/benchmarks; BENCH=digits for one)
	$(VENV)/bin/python benchmarks $(BENCH)

lint: env ## ruff and pyright, without findings
	$(RUN) ruff check .
	$(RUN) ruff format --check .
	$(RUN) pyright --warnings

format: env ## sort imports, fix what ruff can fix, format
	$(RUN) ruff check --fix .
	$(RUN) ruff format .

design: env ## the coating on which a ball of steel wears least; half a minute the first time
	$(VENV)/bin/plgwear design design/steel_ball.toml

studies: env ## every scene and study of design/, into docs and docs/studies; some minutes
	@mkdir -p docs/studies
	@$(VENV)/bin/plgwear design docs/tutorial/ball.toml --picture docs/tutorial/ball-design.png
	@set -e; for scene in design/*.toml; do \
		$(VENV)/bin/plgwear design $$scene --picture docs/studies/$$(basename $$scene .toml)-design.png; done
	@$(VENV)/bin/plgwear solve design/coatings/layers.toml --picture docs/studies/layers-stress.png
	@$(VENV)/bin/plgwear design design/coatings/free_gradient.toml --picture docs/studies/free_gradient-design.png
	@set -e; for study in $(STUDIES); do echo; echo $$study; $(VENV)/bin/python design/$$study.py; done

figures: env numbers ## the figures of the paper, into docs/figures, and what agrees, into build; the numbers into docs/reference/hess_numbers.md
	$(VENV)/bin/plgwear figures --out docs/figures
	@mkdir -p build && mv docs/figures/figures.md build/figures.md && cat build/figures.md

numbers: env ## the numbers of the paper against the reference implementation, into docs/reference/hess_numbers.md; those quoted from tables, into all pages
	$(VENV)/bin/python tests/reference/paper_numbers.py --write docs/reference/hess_numbers.md
	$(VENV)/bin/python docs/generated.py --printed

words: env ## the words of each page
	$(VENV)/bin/python docs/generated.py --words

docs: $(DOCS)/.stamp ## the documentation, into build/site, in an environment of its own
	NO_MKDOCS_2_WARNING=1 $(DOCS)/bin/python -m mkdocs build --strict --quiet
	@echo 'build/site/index.html; to search it: python3 -m http.server --directory build/site'

notebooks: env ## all notebooks, run in place with their outputs; some minutes
	$(VENV)/bin/python notebooks/execute.py

lock: ## resolve the pins again: constraints.txt (newest), constraints-lowest.txt (lowest declared), constraints-docs.txt
	$(call venv,$(LOCK),python3.11 python3)
	@$(LOCK)/bin/python $(PIP) install uv
	@echo 'click<8.3' > $(LOCK)/lowest.txt # the lowest typer cannot work with newer ones
	$(RESOLVE) --extra dev --output-file constraints.txt
	$(RESOLVE) --extra test --resolution lowest-direct --constraint $(LOCK)/lowest.txt --output-file constraints-lowest.txt
	$(RESOLVE) --extra docs --output-file constraints-docs.txt
	@rm -rf $(LOCK)

clean: ## remove the environments, caches and build products
	rm -rf $(VENV) $(LOWEST) $(NEWEST) $(LOCK) $(DOCS) build dist .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(VENV)/.stamp: pyproject.toml constraints.txt
	$(call venv,$(VENV),python3 python3.14 python3.13 python3.12 python3.11 python)
	@echo 'installing the pinned dependencies into $(VENV): half a minute, only when they change'
	@$(VENV)/bin/python $(PIP) install --only-binary :all: -c constraints.txt -e '.[dev]'
	@touch $@

$(LOWEST)/.stamp: pyproject.toml constraints-lowest.txt
	$(call venv,$(LOWEST),python3.11 python3.12 python3)
	@echo 'installing the lowest declared versions into $(LOWEST): half a minute, only when they change'
	@$(LOWEST)/bin/python $(PIP) install --only-binary :all: -c constraints-lowest.txt -e '.[test]'
	@touch $@

$(NEWEST)/.stamp: pyproject.toml
	$(call venv,$(NEWEST),python3.14 python3.13 python3.12 python3 python3.11)
	@echo 'installing the newest versions into $(NEWEST): half a minute; make clean forgets them'
	@$(NEWEST)/bin/python $(PIP) install --upgrade --only-binary :all: -e '.[test]'
	@touch $@

$(DOCS)/.stamp: pyproject.toml constraints-docs.txt
	$(call venv,$(DOCS),python3 python3.14 python3.13 python3.12 python3.11 python)
	@echo 'installing what the documentation is built with into $(DOCS): half a minute, only when it changes'
	@$(DOCS)/bin/python $(PIP) install --only-binary :all: -c constraints-docs.txt -e '.[docs]'
	@touch $@

# $(call venv,DIRECTORY,CANDIDATES): a virtual environment, made by $(PYTHON) or by the first candidate that will do
define venv
@$(1)/bin/python -m pip --version >/dev/null 2>&1 || { \
	for python in $(or $(PYTHON),$(2)); do \
		"$$python" -c 'import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || continue; \
		"$$python" -m venv --clear $(1) && exit; \
	done; \
	echo 'no Python 3.11 or newer with venv found (tried: $(or $(PYTHON),$(2))); name one with PYTHON=...' >&2; \
	exit 1; }
endef

# for the oldest Python that is supported, wheels only; names and versions, nothing else
RESOLVE = $(LOCK)/bin/uv pip compile pyproject.toml --quiet --upgrade --python-version 3.11 --no-build --no-annotate --no-header
