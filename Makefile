# make demo: install and run the main job; make test: the tests; make check: what CI checks besides;
# make validate: compare with other codes and write docs/validation.md (minutes; what is not installed is left out);
# make fuzz: 10,000 malformed inputs, then runs that are interrupted, killed and out of disk (half an hour);
# make docs: the documentation site, in out/docs;
# make mutants: whether the tests catch deliberate errors in the physics (minutes);
# make dist: sdist and wheel into dist/; make wheels: the wheel in empty environments on every Python that is there;
# make benchmark: how long commands take, and a comparison with Exudyn (minutes; nothing else should run).
PYTHON ?= python3
BIN := .venv/bin
EXAMPLE := examples/f16_8g_turn.toml
# Compiled programs are kept here between test runs.
CACHE := $(CURDIR)/.cache/jax

# Folders that ruff reads.
CODE := src tests validation fuzz mutants benchmarks examples docs .ci

.PHONY: demo test check validate fuzz docs benchmark mutants dist wheels lock clean

demo: .venv/installed
	$(BIN)/gbeam run $(EXAMPLE) --out out/f16_8g_turn

test: .venv/dev-installed
	JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/pytest -n 2 --dist loadfile

check: .venv/dev-installed
	$(BIN)/ruff check $(CODE)
	$(BIN)/ruff format --check $(CODE)
	$(BIN)/mypy
	$(BIN)/lint-imports

# One module: .venv/bin/python -m validation --only NAME. What ran before is kept in validation/results.
validate: .venv/dev-installed
	OPENBLAS_NUM_THREADS=1 JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m validation

# The page made from the scenario's schema, then the site; warnings are errors, and nothing is fetched from a network.
docs: .venv/dev-installed
	$(BIN)/gbeam schema --markdown > docs/scenario.md
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going docs out/docs
	@echo "out/docs/index.html"

# Linux; a disk that is full needs root. What is wrong is kept in fuzz/findings, and repeated by --repeat FILE.
fuzz: .venv/dev-installed
	OPENBLAS_NUM_THREADS=1 JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m fuzz
	OPENBLAS_NUM_THREADS=1 JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m fuzz.faults

benchmark: .venv/dev-installed
	$(BIN)/python benchmarks/latency.py
	$(BIN)/python benchmarks/exudyn.py

# One: .venv/bin/python -m mutants WORDS OF ITS NAME
mutants: .venv/dev-installed
	JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m mutants --jobs 2

dist: .venv/uv-installed
	$(BIN)/python .ci/dist.py

wheels: dist
	OPENBLAS_NUM_THREADS=1 $(BIN)/python .ci/wheels.py

.venv/installed: pyproject.toml requirements.lock
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	@touch $@

.venv/dev-installed: .venv/installed requirements-dev.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements-dev.lock
	@touch $@

.venv/uv-installed: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check uv
	@touch $@

# After a change of the dependencies: one lock for every supported Python and platform.
lock: .venv/uv-installed
	$(BIN)/uv pip compile --quiet --universal --no-header --no-emit-index-url --no-annotate \
		pyproject.toml -o requirements.lock
	$(BIN)/uv pip compile --quiet --universal --no-header --no-emit-index-url --no-annotate \
		pyproject.toml --group dev -o requirements-dev.lock

clean:
	rm -rf .venv .cache out dist
