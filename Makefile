# Everything needs only Python >= 3.11, a Rust toolchain and make: the virtual environment is made here.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
SOURCES := $(shell find rust/core rust/python -name '*.rs' -o -name Cargo.toml) Cargo.toml pyproject.toml

.PHONY: demo test check nightly lint format bench fuzz generate clean

demo: $(VENV)/installed ## Fly seven simulated vehicles and show their live picture
	@$(BIN)/mav demo

test: $(VENV)/installed ## Run everything that continuous integration runs
	$(BIN)/ruff check . && $(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	cargo fmt --all --check
	cargo clippy --all-targets --release --locked -- -D warnings
	cargo test --release --locked -p mavstack-core
	$(BIN)/python -m mavstack.dialects.generate --check
	$(BIN)/python -m mavstack.sync.generate --check
	$(BIN)/pytest -n auto -m "not interop"
	$(BIN)/pytest -m interop

check: $(VENV)/installed ## The Python tests alone
	$(BIN)/pytest -n auto

nightly: $(VENV)/installed ## The randomised tests alone, each over SEEDS (10000)
	$(BIN)/pytest -n auto -m seeds --seeds $(or $(SEEDS),10000)

bench: $(VENV)/installed ## Compare speed and memory with the peers
	$(BIN)/python -m benchmarks

fuzz: $(VENV)/installed ## Fuzz each target for SECONDS (600)
	rust/fuzz/run $(or $(SECONDS),600)

format: $(VENV)/installed ## Put the code into its usual form
	$(BIN)/ruff check --fix . && $(BIN)/ruff format . && cargo fmt --all

generate: $(VENV)/installed ## Make tables and stubs anew from the definitions
	$(BIN)/python -m mavstack.dialects.generate
	$(BIN)/python -m mavstack.sync.generate

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"

$(VENV)/installed: $(VENV)/bin/python $(SOURCES)
	$(BIN)/python -m pip install --quiet --group dev
	$(BIN)/python -m pip install --quiet --editable ".[all]"
	@touch $@

clean: ## Remove what was built
	rm -rf $(VENV) target rust/fuzz/target
