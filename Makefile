# Two commands do everything on a fresh machine with Python 3.11 and make: `make run`, `make test`.
PYTHON ?= python3
IN := $(if $(filter Windows_NT,$(OS)),Scripts,bin)
BIN := .venv/$(IN)
OUT ?= out

.PHONY: run test test-all lint wheel test-wheel studies measured cases docs constraints clean
.DEFAULT_GOAL := run

# A dot a second while a command says nothing for long.
ALIVE := sh -c 'while sleep 1; do printf .; done & trap "kill $$!" EXIT; "$$@"' alive

# The build backend is pinned too: no build isolation, so pip fetches nothing that constraints.txt does not name.
.venv/.installed: pyproject.toml constraints.txt
	$(ALIVE) $(PYTHON) -m venv .venv
	$(ALIVE) $(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt hatchling editables
	$(ALIVE) $(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt --no-build-isolation -e '.[demos,flexible,studies,bring,gym,learn,docs,dev]'
	touch $@

run: .venv/.installed
	$(BIN)/python -m rigidarea demo all --out $(OUT)/gallery

lint: .venv/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test: .venv/.installed lint
	$(BIN)/python -m pytest -n 2 -m 'not slow'

test-all: .venv/.installed lint
	$(BIN)/python -m pytest

# Machine code ahead of time (minutes), and dist/*.whl with it; on Linux audited as what its name promises.
wheel: .venv/.installed
	$(ALIVE) $(BIN)/python -m pip install -q --disable-pip-version-check -c constraints.txt ziglang auditwheel
	$(BIN)/python tools/library.py $(OUT)/library
	rm -rf dist
	RIGIDAREA_LIBRARY=$(OUT)/library $(BIN)/python -m pip wheel -q --no-deps --no-build-isolation -w dist .
	$(BIN)/python tools/audit.py dist/*.whl

# The wheel in an environment of its own, without numba, tested by all tests that do not build anything; WITH: other
# versions beside it (CI: the oldest of all). Beside the tests lies all but the package.
WITH ?=
BESIDE = $(filter-out rigidarea dist $(firstword $(subst /, ,$(OUT))),$(wildcard *))
test-wheel:
	rm -rf $(OUT)/installed
	$(ALIVE) $(PYTHON) -m venv $(OUT)/installed
	$(ALIVE) $(OUT)/installed/$(IN)/python -m pip install -q --disable-pip-version-check "$$(echo dist/*.whl)[all,dev]" $(WITH)
	cp -r $(BESIDE) $(OUT)/installed
	cd $(OUT)/installed && PYTHONPATH= $(IN)/python -m pytest -n 2 -m 'not slow'

# Measures anew all that README.md and docs/ show, and renews those pages: hours. `make docs` says what is of another
# solver; one part alone: its line here, without $(OUT).
studies: .venv/.installed measured cases
	$(BIN)/python -m rigidarea chart --out $(OUT)/chart --docs docs
	$(BIN)/python -m rigidarea atlas --out $(OUT)/atlas --docs docs
	$(BIN)/python -m rigidarea bench everyday --out $(OUT)/bench --docs docs
	$(BIN)/python -m rigidarea bench growth --out $(OUT)/bench --docs docs
	$(BIN)/python -m rigidarea compare --out $(OUT)/compare --docs docs
	$(BIN)/python -m rigidarea plan --validate --out $(OUT)/plan --docs docs
	$(BIN)/python -m rigidarea compat tests --docs docs
	$(BIN)/python -m rigidarea compat examples --docs docs
	$(BIN)/python -m rigidarea demo all --no-film --out $(OUT)/gallery
	cp $(OUT)/gallery/*.png docs/

# What tests measure and pages show (SHOWN="shown": the slow ones too).
SHOWN ?= shown and not slow
measured: .venv/.installed
	$(BIN)/python -m pytest tests -m '$(SHOWN)' --results=docs/results/tests.json

# The paper's examples.
cases: .venv/.installed
	for name in hertz patch pin-joint geneva gearbox; do \
	  $(BIN)/python -m rigidarea case $$name --out $(OUT)/case --json docs/results/case-$$name.json || exit 1; done

# Runs every page's snippets, draws their pictures and makes their figures anew, builds the site without a warning
# into $(OUT)/site.
docs: .venv/.installed
	$(BIN)/python tools/pages.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --site-dir $(OUT)/site

# Rewrites constraints.txt from what is installed now (after a deliberate upgrade).
constraints: .venv/.installed
	$(BIN)/python -m pip freeze --exclude-editable > constraints.txt

clean:
	rm -rf .venv out .pytest_cache .mypy_cache .ruff_cache .hypothesis
