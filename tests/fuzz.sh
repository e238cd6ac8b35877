#!/bin/sh
# Coverage-guided fuzzing of every file reader and of the C ABI, with AddressSanitizer, debug assertions, overflow
# checks, and limits on memory and time. Run it by hand: it needs a nightly toolchain, cargo-fuzz (cargo install
# cargo-fuzz) and a C++ compiler. The library itself writes the seed files (cargo build --release, make setup).
#
#   tests/fuzz.sh [SECONDS] [TARGET...]     runs each target for SECONDS (default 600); default: all targets
#
# The targets: image (PNG, JPEG, WebP, TIFF, BMP, GIF, Radiance HDR, and the metadata of cameras in them), exr, gltf
# (GLB and glTF), ies, ldt, tm33 and gldf (luminaires), onnx (networks, which are also run), lpe (light path
# expressions, which are also rendered), strokes, part (parts of a rendering, which are merged), calls (sequences of
# calls to all functions of the header).
#
# Corpora grow in target/fuzz/corpus from run to run. Inputs that fail are in target/fuzz/artifacts. To run one again,
# and to minimise it:
#
#   target/fuzz/x86_64-unknown-linux-gnu/release/TARGET FILE
#   target/fuzz/x86_64-unknown-linux-gnu/release/TARGET -minimize_crash=1 -max_total_time=60 FILE
set -eu
cd "$(dirname "$0")/.."
build="$PWD/target/fuzz"
seconds="${1:-600}"
[ $# -eq 0 ] || shift
targets="${*:-image exr gltf ies ldt tm33 gldf onnx lpe strokes part calls}"

cargo +nightly fuzz build --fuzz-dir fuzz --target-dir "$build"
target/peers/python/bin/python fuzz/seeds.py "$build/seeds"

# Calls that write files write them into this folder.
mkdir -p "$build/work" "$build/artifacts"
cd "$build/work"
failed=
for target in $targets; do
  # Memory limits in MiB. Objects are limited to 64 MiB (fuzz/src/lib.rs); a single allocation may have twice as much,
  # and the whole process more, because of the sanitizer. A network may take 1 GiB for its values (src/network/run.rs)
  # and as much for a node, and filling that takes seconds.
  rss=768 single=128 time=10
  # Before it decodes an image, the library tests by an allocation, which it does not touch, whether the codec has
  # enough memory.
  case "$target" in image | exr | part | gltf) single=1024 ;; esac
  [ "$target" != onnx ] || { rss=3072; single=1024; time=30; }
  # An expression may grow to 4096 states, which takes 0.2 s without the sanitizer and many times as long with it.
  [ "$target" != lpe ] || time=30
  limits=
  # The hundred calls may request images of any size: too large an allocation fails, as on a machine without free
  # memory.
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
