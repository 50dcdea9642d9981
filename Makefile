# The habits of this house. `make` alone lists them.

.DEFAULT_GOAL := help
.PHONY: help format lint test doc run bench streams seeds fuzz libfuzzer peers golden ci

PEERS := target/peers
LIBFUZZER := target/libfuzzer
SECONDS ?= 180

help: ## List these targets
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-9s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

format: ## Rewrite the sources in the house's format
	cargo fmt --all

lint: ## Check format and lints, warnings being errors
	cargo fmt --all --check
	cargo clippy --workspace --all-targets -- -D warnings

test: ## Run every test
	cargo test --workspace

doc: ## Build the documentation of the code, broken links being errors
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps

run: ## Evolve the quick start: crawlers under gene regulatory networks
	cargo run --release -- run experiments/quickstart.toml

bench: ## Measure engine, evaluation, dispatch and lineage, each against its peer in one run, and a flyer's step
	cargo build --release --bins --workspace
	for bench in engine evaluation dispatch lineage; do target/release/$$bench || exit 1; done
	cargo run --release -p creatures --example flyer_rates

streams: ## Attach up to 10,000 workers to one coordinator, and measure what each costs
	cargo build --release --bins --workspace
	target/release/streams

seeds: ## Live 20,000 simulated lives of a fleet
	HATCHERY_SEEDS=20000 cargo test -p hatchery-tests --test simulation whatever

fuzz: ## Bring a million mutations to every decoder
	HATCHERY_FUZZ_RUNS=1000000 cargo test -p hatchery-fuzz

libfuzzer: ## Let coverage lead libFuzzer through every decoder, SECONDS=180 each (needs cargo-fuzz)
	for target in $(notdir $(basename $(wildcard fuzz/libfuzzer/targets/*.rs))); do \
		mkdir -p $(LIBFUZZER)/corpus/$$target && RUSTC_BOOTSTRAP=1 cargo fuzz run --fuzz-dir fuzz/libfuzzer \
			--target-dir $(LIBFUZZER) --sanitizer none $$target $(LIBFUZZER)/corpus/$$target fuzz/corpus/$$target \
			-- -max_total_time=$(SECONDS) -timeout=10 || exit 1; \
	done

peers: $(PEERS)/installed ## Measure MuJoCo, a Python process pool and Ray under the same loads
	$(PEERS)/bin/python benches/peers/mujoco_walkers.py
	cargo build --release -p creatures --example esp_steps --example flyer_rates
	$(PEERS)/bin/python benches/peers/mujoco_esp.py target/release/examples/esp_steps
	$(PEERS)/bin/python benches/peers/mujoco_flyers.py target/release/examples/flyer_rates
	$(PEERS)/bin/python benches/peers/pool.py
	$(PEERS)/bin/python benches/peers/ray_tasks.py

$(PEERS)/installed: benches/peers/requirements.txt
	python3 -m venv $(PEERS)
	$(PEERS)/bin/pip install --quiet --requirement $<
	touch $@

golden: ## Write the golden lineage hashes anew, after a change that is meant to move them
	UPDATE_GOLDEN=1 cargo test -p hatchery-tests --test golden

ci: ## Run what must hold before a change lands
	.ci/run
