# make demo: install and run the main job; make test: the tests; make check: what CI checks besides;
# make validate: compare with other codes and write docs/validation.md (minutes; what is not installed is left out);
# make fuzz: the theorems of the tests on new examples, 10,000 malformed inputs, then runs that are interrupted, killed
# and out of disk (half an hour);
# make thorough: cases that make test leaves out, for others show the same (minutes);
# make walk: every verb over every example and more trees, its files read again, its page opened (hours);
# make docs: the documentation site, in out/docs;
# make pictures: those of the README and the first tutorial, from the F-16 example;
# make changelog: what the fragments in changes/ tell of the next release;
# make web: the viewer and the app's page, from web/ into the package, with the licences of what they hold in NOTICE
# (needs Node; users of the package do not);
# make web-check: their tests, and whether what is built in the package is that of web/;
# make mutants: whether the tests catch deliberate errors in the physics (minutes);
# make audit: whether what is locked has known vulnerabilities (needs a network);
# make dist: sdist and wheel into dist/; make wheels: the wheel in empty environments on every Python that is there;
# make benchmark: how long commands take, and a comparison with Exudyn (minutes; nothing else should run).
PYTHON ?= python3
BIN := .venv/bin
EXAMPLE := examples/f16_8g_turn.toml
# Compiled programs are kept here between test runs.
CACHE := $(CURDIR)/.cache/jax
# glibc keeps the memory of large arrays for the next ones: what it gives back is zeroed anew for every one.
KEEPING := MALLOC_MMAP_THRESHOLD_=33554432 MALLOC_TRIM_THRESHOLD_=536870912

# Where this is set, every process that a test starts compiles all of gbeam anew.
unexport PYTHONDONTWRITEBYTECODE

# Folders that ruff reads.
CODE := src tests validation fuzz mutants benchmarks examples docs .ci

.PHONY: demo test web web-check check validate fuzz thorough walk docs pictures changelog benchmark mutants dist wheels lock audit clean

demo: .venv/installed
	$(BIN)/gbeam run $(EXAMPLE) --out out/f16_8g_turn

# The browser tests take the Chromium that is there, or one from npm; where neither can be had they are skipped.
test: .venv/dev-installed
	$(BIN)/python .ci/browser.py
	JAX_COMPILATION_CACHE_DIR=$(CACHE) $(KEEPING) $(BIN)/pytest -n 2 --dist loadfile

web: web/node_modules/.installed
	cd web && npm run --silent build && npm test --silent

web-check: web/node_modules/.installed
	rm -rf out/web out/web-app && mkdir -p out
	cd web && npm test --silent && GBEAM_WEB_OUT=../out/web npm run --silent build -- --logLevel warn
	diff -r out/web src/gbeam/report/page/assets && diff -r out/web-app src/gbeam/app/assets && diff out/web-NOTICE NOTICE || { echo "what is built is not that of web/: run make web"; exit 1; }

web/node_modules/.installed: web/package-lock.json
	@command -v npm > /dev/null || { echo "the viewer is built by Node 20.19 or later with npm, which is not here"; exit 1; }
	cd web && npm ci --silent
	@touch $@

check: .venv/dev-installed
	$(BIN)/ruff check $(CODE)
	$(BIN)/ruff format --check $(CODE)
	$(BIN)/mypy
	$(BIN)/lint-imports

# One module: .venv/bin/python -m validation --only NAME. What ran before is kept in validation/results.
validate: .venv/dev-installed
	OPENBLAS_NUM_THREADS=1 JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m validation

# The pages made from schemas and records, each put in its place at once, for tests that read it meanwhile; then the site;
# warnings are errors, and nothing is fetched from a network.
docs: .venv/dev-installed
	mkdir -p out
	$(BIN)/gbeam schema --markdown > out/scenario.md && mv out/scenario.md docs/
	$(BIN)/gbeam schema --results --markdown > out/results.md && mv out/results.md docs/
	$(BIN)/python benchmarks/reach.py --markdown > out/speed.md && mv out/speed.md docs/
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going docs out/docs
	@echo "out/docs/index.html"

pictures: .venv/dev-installed
	OPENBLAS_NUM_THREADS=1 $(BIN)/python docs/pictures.py

changelog: .venv/dev-installed
	$(BIN)/towncrier build --draft --version next

# Linux; a disk that is full needs root. What is wrong is kept in fuzz/findings, and repeated by --repeat FILE.
fuzz: .venv/dev-installed
	JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/pytest -n 2 --dist loadfile -m hypothesis --hypothesis-profile search
	OPENBLAS_NUM_THREADS=1 JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m fuzz
	OPENBLAS_NUM_THREADS=1 JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m fuzz.faults

thorough: .venv/dev-installed
	JAX_COMPILATION_CACHE_DIR=$(CACHE) $(KEEPING) $(BIN)/pytest -n 2 -m thorough

# Some of it: .venv/bin/python -m fuzz.walk robot_arm run
walk: .venv/dev-installed
	$(BIN)/python .ci/browser.py
	OPENBLAS_NUM_THREADS=1 JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m fuzz.walk

benchmark: .venv/dev-installed
	$(BIN)/python benchmarks/latency.py
	$(BIN)/python benchmarks/exudyn.py
	$(BIN)/python benchmarks/batch.py

# One: .venv/bin/python -m mutants WORDS OF ITS NAME; those of a folder of the package: make mutants ROOM=solids
mutants: .venv/dev-installed
	JAX_COMPILATION_CACHE_DIR=$(CACHE) $(BIN)/python -m mutants --jobs 2 --room '$(ROOM)'

dist: .venv/uv-installed
	$(BIN)/python .ci/dist.py

wheels: dist
	OPENBLAS_NUM_THREADS=1 $(BIN)/python .ci/wheels.py

.venv/installed: pyproject.toml requirements.lock
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	@touch $@

# Python compiles what is imported; pip would compile everything, for a minute. What readers import is compiled here, for
# they have 10 s of processor time.
.venv/dev-installed: .venv/installed requirements-dev.lock
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --require-hashes -r requirements-dev.lock
	$(BIN)/python -c "import meshio, pyyeti.nastran"
	@touch $@

.venv/uv-installed: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check uv
	@touch $@

# After a change of the dependencies: one lock for every supported Python and platform, with the hash of every file.
lock: .venv/uv-installed
	$(BIN)/uv pip compile --quiet --universal --no-header --no-emit-index-url --no-annotate --generate-hashes \
		pyproject.toml -o requirements.lock
	$(BIN)/uv pip compile --quiet --universal --no-header --no-emit-index-url --no-annotate --generate-hashes \
		pyproject.toml --group dev -o requirements-dev.lock

# The database is that of PyPI's advisories; without a network there is no answer, which is said and is a failure.
audit: .venv/audit-installed
	$(BIN)/python .ci/audit.py requirements.lock requirements-dev.lock

.venv/audit-installed: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check pip-audit
	@touch $@

clean:
	rm -rf .venv .cache out dist web/node_modules
