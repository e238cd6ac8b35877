#!/bin/sh
# Runs tests in Miri, which interprets the code and checks every memory access, borrow and leak: the `unsafe` code and
# the contract of the C ABI, the allocator, and image views and buffers. Run it by hand: it needs a nightly toolchain
# with miri (rustup component add miri --toolchain nightly) and some minutes.
#
#   tests/miri.sh
#
# Miri supports neither the floating-point mode register nor huge pages, so the library omits these lines under Miri.
set -eu
cd "$(dirname "$0")/.."
# Allow access to time and files. Use tree borrows, because rayon's queues (crossbeam-epoch) store bits in pointers and
# violate the older rules (stacked borrows).
export MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-tree-borrows -Zmiri-permissive-provenance" CARGO_TARGET_DIR="$PWD/target/miri"

# Skip one test: the payload of a caught panic is forgotten on purpose, which Miri reports as a leak.
cargo +nightly miri test --locked --lib -- ffi:: image::view image::buffer reserve:: --skip panics_and_errors_become_statuses

# Test the contract as a host uses it. Ignore leaks, because rayon keeps its queues for the lifetime of the process.
# Skip the test that fills a MiB, which would take minutes.
MIRIFLAGS="$MIRIFLAGS -Zmiri-ignore-leaks" cargo +nightly miri test --locked --test abi contract:: -- --skip the_memory_budget_holds
echo "miri: nothing found"
