# make demo   builds the library and runs the lighting transfer on rooms that it makes itself, into out/
# make test   installs what the tests need, where it is missing, and runs all of them
# make clean

CARGO ?= cargo
CC ?= cc
BUILD := build
RELEASE := target/release
SONAME := libluxfer.so.0.1

.PHONY: all library demo test setup test-rust test-cpp clean

all: library

# The link has the name that programs look for at run time.
library:
	$(CARGO) build --release
	ln -sf libluxfer.so $(RELEASE)/$(SONAME)

demo: library
	mkdir -p out
	$(CC) -std=c99 -O2 -Wall -Wextra -Wpedantic -Iinclude examples_c/lighting_transfer.c -o $(RELEASE)/lighting_transfer \
	    -L$(RELEASE) -lluxfer -Wl,-rpath,'$$ORIGIN' -lm
	cd out && ../$(RELEASE)/lighting_transfer

test: setup test-rust test-cpp

# Debian's names of what the C++ harnesses compare with. Nothing is installed that is there already.
setup:
	@missing=""; \
	command -v cmake >/dev/null || missing="$$missing cmake"; \
	command -v c++ >/dev/null || missing="$$missing g++"; \
	command -v nm >/dev/null || missing="$$missing binutils"; \
	for package in libopencv-dev libembree-dev; do \
	    dpkg-query -W -f='$${Status}' $$package 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$package"; \
	done; \
	test -z "$$missing" && exit 0; \
	echo "installing:$$missing"; \
	if ! command -v apt-get >/dev/null; then \
	    echo "make test needs$$missing, and there is no apt-get here: install them, then run it again" >&2; exit 1; fi; \
	as_root=""; \
	if [ "$$(id -u)" != 0 ]; then \
	    as_root="sudo -n"; \
	    $$as_root true 2>/dev/null </dev/null || { \
	        echo "make test needs$$missing; run as root: apt-get install$$missing" >&2; exit 1; }; fi; \
	$$as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq </dev/null && \
	$$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $$missing </dev/null

test-rust: library
	$(CARGO) test

test-cpp: library
	cmake -S . -B $(BUILD) -DLUXFER_LIB_DIR=$(CURDIR)/$(RELEASE)
	cmake --build $(BUILD) --parallel 2
	ctest --test-dir $(BUILD) --output-on-failure

clean:
	$(CARGO) clean
	rm -rf $(BUILD) out
