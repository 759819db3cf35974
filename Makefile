# Everything needs only Python >= 3.11, a C linker and make: the virtual environment is made here.

PYTHON ?= python3
# A named interpreter has its own environment: .venv-3.13.
VENV ?= .venv$(if $(filter command line,$(origin PYTHON)),-$(shell $(PYTHON) -c "import sys; print('%d.%d' % sys.version_info[:2])"))
BIN := $(VENV)/bin
SOURCES := $(shell find rust/core rust/intake rust/logs rust/router rust/swarm rust/python -name '*.rs' -o -name Cargo.toml) Cargo.toml pyproject.toml

# A toolchain of the system, or one in .tools (MAVSTACK_NO_DOWNLOAD=1: none is downloaded).
RUST := $(PYTHON) backend/mavstack_rust.py

# Some tests wait for other programs: with a worker more than cores no core waits with them.
FAST_WORKERS := $(or $(WORKERS),$(shell $(PYTHON) -c "import os; print((os.cpu_count() or 1) + 1)"))

# Hundreds of tests talk over real sockets in real time: a failed test runs once more, and the summary names it.
PYTEST := $(BIN)/pytest --reruns 1 -r fER

# Test files that name a marker, with the options $(2) of grep: each worker needs half a minute to collect all files.
# tests/tiers.py makes sure that a file names the tiers of its tests.
files_marked = $$(grep --recursive --files-with-matches --extended-regexp --include='test_*.py' $(2) 'mark\.($(1))' tests | LC_ALL=C sort)

# The target for which the core is built with a sanitizer, so that build scripts are not.
SANITIZED_HOST = $(shell uname -m)-unknown-linux-gnu

# Modules are compiled once, not by every worker and every `mav` that a test starts.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: rust demo station station-tests test flights interop nightly check newest lint lint-python lint-rust lint-station rust-tests test-programs compiled-tests docs format bench \
	sanitize valgrind fuzz generate clean

demo: $(VENV)/package ## Fly eight simulated vehicles and show their live picture; WEB=1: in the browser too
	@$(if $(WEB),$(MAKE) --no-print-directory station)
	@trap : INT; $(BIN)/mav demo $(if $(WEB),--web) || [ $$? -eq 130 ]  # Ctrl-C is its usual end

station: $(VENV)/package ## Build the browser ground station that `mav web` serves
	@$(BIN)/python backend/mavstack_station.py --install

station-tests: $(VENV)/package
	@$(BIN)/python backend/mavstack_station.py --install --test

lint-station: $(VENV)/package
	@$(BIN)/python backend/mavstack_station.py --install --lint

# One core is busy with the link of the package or with downloads, the other one checks the Rust code.
test: ## Run the fast tier: lint, types, unit and property tests, one smoke test per peer
	@$(MAKE) --no-print-directory --jobs 2 --output-sync rust-tests $(VENV)/installed
	@$(MAKE) --no-print-directory --jobs 2 --output-sync lint-python station-tests test-programs compiled-tests
	$(PYTEST) -n $(FAST_WORKERS) --dist loadgroup --durations 10 -m "not nightly and not flight and (not interop or smoke)" --seeds $(or $(SEEDS),30)

flights: $(VENV)/installed ## Run the tests that take seconds of processor time each, mostly simulated flights
	$(PYTEST) -n $(or $(WORKERS),auto) --dist loadgroup --durations 10 -m "flight and not nightly and not interop" --seeds $(or $(SEEDS),30) \
	  $(call files_marked,flight|fast_cases)

test-programs: $(VENV)/installed
	@$(BIN)/python -m tools.compilers test

# Beside the type check, once: otherwise each worker compiles all test modules. What fails here is reported by the tests.
compiled-tests: $(VENV)/installed
	@$(BIN)/pytest --collect-only > /dev/null || true

# Compilers run apart, since the other programs have timeouts in real time.
interop: $(VENV)/installed station ## Run the other tests with programs that are not ours, several at a time: they mostly wait
	@$(BIN)/python -m tools.compilers interop
	$(PYTEST) -n $(or $(WORKERS),4) --dist loadgroup --durations 10 -m "interop and not smoke and not nightly" \
	  $(call files_marked,interop,--exclude-dir=codegen)
	$(PYTEST) -n $(or $(WORKERS),auto) --dist loadgroup --durations 5 -m "interop and not smoke and not nightly" tests/codegen

nightly: $(VENV)/installed ## Run the long tests, the randomised ones over SEEDS (10000) each
	@$(BIN)/python -m tools.compilers nightly
	$(RUST) cargo test --quiet --profile checks --locked -p mavstack-router -- --ignored
	@if $(BIN)/python -c "import atheris" 2> /dev/null; then rust/fuzz/run 60 streams; else echo "atheris is not installed: fuzzing skipped"; fi
	$(BIN)/pytest -n auto --dist loadgroup -m nightly --seeds 300 --timeout 1800 -o faulthandler_timeout=1860
	$(BIN)/pytest -n auto --dist loadgroup -m "properties and not interop" --hypothesis-profile thorough --timeout 7200 -o faulthandler_timeout=7260
	$(BIN)/pytest -n auto --dist loadgroup -m seeds --seeds $(or $(SEEDS),10000) --timeout 7200 -o faulthandler_timeout=7260

check: $(VENV)/installed ## Run the Python tests of the fast tier alone; TESTS="tests/logs …": those of some folders
	$(BIN)/pytest -n auto --dist loadgroup -m "not nightly and not flight and not interop" --seeds $(or $(SEEDS),30) $(TESTS)

# Its dependencies are newer too, and what they announce to remove is an error (`filterwarnings`).
newest: $(VENV)/installed ## Run `check` on the newest Python of this machine, unless that is the one of the environment
	@newest=$$($(BIN)/python -m tools.interpreters); [ -z "$$newest" ] || $(MAKE) --no-print-directory check \
	PYTHON="$$newest" $(if $(filter command line,$(origin VENV)),VENV=$(VENV)-newest)

lint: lint-python lint-rust lint-station ## Check style, types, layers, vocabulary and generated files

lint-python: $(VENV)/installed
	$(BIN)/ruff check . && $(BIN)/ruff format --check .
	$(BIN)/python -m tools.vocabulary
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache
	$(BIN)/lint-imports --no-cache run-time-imports.toml
	$(BIN)/python -m mavstack.dialects.generate --check
	$(BIN)/python -m mavstack.sync.generate --check

lint-rust: | rust
	$(RUST) cargo fmt --all --check
	$(RUST) cargo clippy --quiet --all-targets --profile checks --locked -- -D warnings

rust-tests: lint-rust
	env -u MAKEFLAGS -u MFLAGS $(RUST) cargo test --quiet --profile checks --locked -p mavstack-core -p mavstack-intake -p mavstack-logs -p mavstack-router -p mavstack-swarm

docs: $(VENV)/installed ## Build the documentation site in site/, and search it
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	$(BIN)/pytest -q tests/docs/test_search.py

bench: $(VENV)/installed ## Compare speed and memory with the peers
	$(BIN)/python -m benchmarks

sanitize: $(VENV)/installed ## Run tests of the core under AddressSanitizer (Linux, gcc); TESTS="tests/logs …": those of some folders
	$(RUST) env RUSTC_BOOTSTRAP=1 RUSTFLAGS=-Zsanitizer=address cargo build --quiet --profile checks --locked -p mavstack-python \
	  --target $(SANITIZED_HOST) --target-dir target/sanitized
	rm -rf target/sanitized/package && mkdir -p target/sanitized/package && cp -r src/mavstack target/sanitized/package
	cp target/sanitized/$(SANITIZED_HOST)/checks/lib_core.so target/sanitized/package/mavstack/_core.abi3.so
	LD_PRELOAD=$$(gcc -print-file-name=libasan.so) ASAN_OPTIONS=detect_leaks=0 PYTHONMALLOC=malloc \
	  PYTHONPATH=target/sanitized/package:. $(BIN)/python -c "import gc, sys, pytest; gc.set_threshold(1); sys.exit(pytest.main(sys.argv[1:]))" \
	  -q -p no:xdist -m "not properties and not interop and not nightly and not seeds" $(or $(TESTS),tests/wire tests/node/test_native_input.py)

# A packet or a message that is used after it was freed is found at its next use; slow: about fifty times. Plug-ins of
# pytest and the fixtures of other tests take most of the time of a run, so that they are left out.
valgrind: $(VENV)/installed ## Run tests of the core under valgrind (Debian's package); TESTS="…": other tests
	@if command -v valgrind > /dev/null; then PYTHONMALLOC=malloc PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 valgrind --quiet --error-exitcode=9 \
	  --errors-for-leak-kinds=none --undef-value-errors=no \
	  $(BIN)/python -m pytest -q -c /dev/null --rootdir . --noconftest -p no:cacheprovider $(or $(TESTS),tests/wire/test_object_lifetime.py); \
	else echo "valgrind is not installed: skipped"; fi

fuzz: $(VENV)/installed ## Fuzz each target for SECONDS (600)
	rust/fuzz/run $(or $(SECONDS),600)

format: $(VENV)/installed ## Put the code into its usual form
	$(BIN)/ruff check --fix . && $(BIN)/ruff format . && $(RUST) cargo fmt --all
	@$(BIN)/python backend/mavstack_station.py --install --format

generate: $(VENV)/installed ## Make tables and stubs from the definitions
	$(BIN)/python -m mavstack.dialects.generate
	$(BIN)/python -m mavstack.sync.generate

# Before anything else is downloaded; without Rust, a toolchain for this folder alone.
rust:
	@$(RUST)

$(VENV)/bin/python: | rust
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"

$(VENV)/package: $(VENV)/bin/python $(SOURCES) | rust
	$(BIN)/python -m pip install --quiet --editable ".[cli,serial,web]"
	@touch $@

# The tools of developers too, several hundred megabytes.
$(VENV)/installed: $(VENV)/package pyproject.toml
	$(BIN)/python -m pip install --quiet --group dev
	@touch $@

clean: ## Remove what was built
	rm -rf $(VENV) .venv-* target rust/fuzz/target src/mavstack/server/static web/node_modules web/src/generated
