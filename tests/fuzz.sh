#!/bin/sh
# Coverage-guided fuzzing of every reader and of the C ABI as a whole, with AddressSanitizer, the assertions of debugging, checks of
# overflow, and limits on memory and time. By hand: it needs a nightly toolchain, cargo-fuzz (cargo install cargo-fuzz) and a C++
# compiler; the seeds come from the library itself (cargo build --release, make setup).
#
#   tests/fuzz.sh [SECONDS] [TARGET...]     default 600, and all targets in turn
#
# image: PNG, JPEG, WebP, TIFF, BMP, GIF, Radiance HDR, and what cameras write into them; exr; gltf: GLB and glTF; ies, ldt:
# luminaires; onnx: networks, which are run; lpe: light path expressions, rendered by; strokes; part: parts of a rendering, merged;
# calls: sequences of calls to all functions of the header.
#
# Corpora grow in target/fuzz/corpus from one run to the next. What fails is in target/fuzz/artifacts; to see it again, and to cut it down:
#
#   target/fuzz/x86_64-unknown-linux-gnu/release/TARGET FILE
#   target/fuzz/x86_64-unknown-linux-gnu/release/TARGET -minimize_crash=1 -max_total_time=60 FILE
set -eu
cd "$(dirname "$0")/.."
build="$PWD/target/fuzz"
seconds="${1:-600}"
[ $# -eq 0 ] || shift
targets="${*:-image exr gltf ies ldt onnx lpe strokes part calls}"

cargo +nightly fuzz build --fuzz-dir fuzz --target-dir "$build"
target/peers/python/bin/python fuzz/seeds.py "$build/seeds"

# Files that calls write are written here.
mkdir -p "$build/work" "$build/artifacts"
cd "$build/work"
failed=
for target in $targets; do
  # Objects are limited to 64 MiB (fuzz/src/lib.rs). A single allocation may be twice that, all of them together four times: the
  # library's, and what the sanitizer adds. A network may take 1 GiB for its values (src/network/run.rs), and as much for a node,
  # which it takes seconds to fill.
  rss=768 single=128 time=10
  # Before an image is decoded the library looks whether there is room for what the codec may take; it does not touch what it gets.
  case "$target" in image | exr | part | gltf) single=1024 ;; esac
  [ "$target" != onnx ] || { rss=3072; single=1024; time=30; }
  # An expression may be looked into until it has 4096 states: 0.2 s without the sanitizer, but many times that with it.
  [ "$target" != lpe ] || time=30
  limits=
  # A hundred calls, which may ask for pictures of any size: such allocations fail, as on a machine without memory.
  [ "$target" != calls ] || { time=60; limits=":allocator_may_return_null=1:max_allocation_size_mb=$single"; }
  mkdir -p "$build/corpus/$target"
  echo "== $target"
  ASAN_OPTIONS="quarantine_size_mb=16:detect_odr_violation=0$limits" \
    "$build/x86_64-unknown-linux-gnu/release/$target" -max_total_time="$seconds" -timeout=$time -rss_limit_mb=$rss -malloc_limit_mb=$single \
    -dict="$build/seeds/$target.dict" -artifact_prefix="$build/artifacts/$target-" -print_final_stats=1 \
    "$build/corpus/$target" "$build/seeds/$target" >"$build/$target.log" 2>&1 || failed="$failed $target"
  grep -aE "^(stat::|SUMMARY|Done)" "$build/$target.log"
  echo "$(find "$build/corpus/$target" -type f | wc -l) inputs in the corpus"
done
if [ -n "$failed" ]; then
  echo "failed:$failed; see $build/*.log and $build/artifacts" >&2
  exit 1
fi
echo "fuzz: nothing found"
