#!/bin/sh
# Miri over the C ABI's own `unsafe` code and its contract, the allocator, and the views and buffers: interpreted, with every
# access to memory, every borrow and every leak checked. By hand: it needs a nightly toolchain with miri (rustup component add miri
# --toolchain nightly), and some minutes.
#
#   tests/miri.sh
#
# Miri knows neither the register of the floating-point mode nor huge pages: those lines are left out for it.
set -eu
cd "$(dirname "$0")/.."
# Time and files of the machine; rayon's queues (crossbeam-epoch) keep bits in pointers, and are not sound by the older rules of stacks.
export MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-tree-borrows -Zmiri-permissive-provenance" CARGO_TARGET_DIR="$PWD/target/miri"

# What a caught panic carries is forgotten on purpose, which counts as a leak.
cargo +nightly miri test --locked --lib -- ffi:: image::view image::buffer reserve:: --skip panics_and_errors_become_statuses

# As a host calls it. What rayon's queues keep for the whole process counts as a leak. A MiB takes minutes to fill.
MIRIFLAGS="$MIRIFLAGS -Zmiri-ignore-leaks" cargo +nightly miri test --locked --test abi_contract -- --skip the_memory_budget_holds
echo "miri: nothing found"
