# Part of the Makefile: packages for several platforms, built on one x86-64 Linux machine. The guide's page "Platforms"
# says what runs where.
#
# make dist-all      builds the packages of all TARGETS into out/dist: archives, Python wheels, Blender extensions,
#                    bills of materials (SBOM) and SHA256SUMS
# make dist-TARGET   builds the packages of one target, such as dist-windows-x86_64; linux-musl-x86_64 and
#                    macos-universal are not among TARGETS, because they have not been built to the end yet
# make dist-check    unpacks, compiles against and runs the packages (under wine64 and qemu where needed), compares the
#                    results bit by bit, and writes the table of the guide; make dist-check TARGETS=linux-x86_64 for one
# make dist-reproduce  builds the packages of linux-x86_64, or of TARGETS, twice: in other folders, for other users;
#                    fails if a file differs
# make light         builds the library without its optional parts (features of Cargo.toml), optimised for size, into
#                    target/light; tests that each missing part says so, and prints the size
# make dist-setup    installs compilers and emulators (Debian packages, PyPI, rustup); the other commands call it

TARGETS   ?= linux-x86_64 linux-aarch64 windows-x86_64
DIST      := out/dist

.PHONY: dist-all dist-check dist-reproduce light dist-setup dist-sums

# The wheels also hold the page of the studio, where npm can build it.
dist-setup:
	@bindings/dist/setup.sh
	@command -v npm >/dev/null && $(MAKE) --no-print-directory studio || echo "no npm: the wheels have no page of the studio" >&2

# One target after the other: each build uses all processors and much memory.
dist-all: dist-setup
	@for target in $(TARGETS); do bindings/dist/pack.sh $$target || exit 1; done
	@$(MAKE) --no-print-directory dist-sums

dist-%: dist-setup
	@bindings/dist/pack.sh $*
	@$(MAKE) --no-print-directory dist-sums

dist-sums:
	@cd $(DIST) && sha256sum luxfer*-* >SHA256SUMS && cat SHA256SUMS

dist-check: dist-setup
	@for target in $(TARGETS); do bindings/dist/check.sh $$target || exit 1; done
	@python3 bindings/dist/table.py

dist-reproduce: TARGETS := $(if $(findstring command,$(origin TARGETS)),$(TARGETS),linux-x86_64)
dist-reproduce:
	@for target in $(TARGETS); do bindings/dist/reproduce.sh $$target || exit 1; done

LIGHT := target/light/light
light:
	$(CARGO) rustc --profile light --lib --locked --no-default-features --crate-type cdylib --target-dir target/light
	@ln -sf libluxfer.so $(LIGHT)/$(notdir $(SONAME))
	@$(CC) -std=c99 -O1 -Wall -Wextra -Wpedantic -Iinclude tests/light/light.c -o $(LIGHT)/test -L$(LIGHT) -lluxfer -lm -Wl,-rpath,'$$ORIGIN'
	@cd $(LIGHT) && ./test && stat -c '%n: %s bytes' libluxfer.so
