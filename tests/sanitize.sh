#!/bin/sh
# Runs programs that use the C ABI under ThreadSanitizer or AddressSanitizer; the library and Rust's standard library
# are instrumented too. Run it by hand: it needs a nightly toolchain with rust-src (rustup component add rust-src
# --toolchain nightly), clang, and a quarter of an hour.
#
#   tests/sanitize.sh thread [HARNESS...]     runs harnesses of tests/cpp; default: those that use threads
#   tests/sanitize.sh address [HARNESS...]    also detects leaks; default: harnesses that need no other library, then
#                                             all C examples
set -eu
cd "$(dirname "$0")/.."
target=x86_64-unknown-linux-gnu
kind="${1:-}"
case "$kind" in
  thread) runtime=tsan harnesses="abi_contract host wrapper_stages" ;;
  address) runtime=asan harnesses="abi_contract bad_input host stylisation wrapper wrapper_stages" ;;
  *) sed -n 's/^# *\(tests.*\)/\1/p' "$0" >&2 && exit 2 ;;
esac
shift
examples=
[ $# -gt 0 ] || [ "$kind" = thread ] || examples="$(cd examples_c && ls ./*.c)"
harnesses="${*:-$harnesses}"
build="$PWD/target/sanitize/$kind"

# Build the library as users have it, without debug assertions.
CARGO_INCREMENTAL=0 CARGO_PROFILE_DEV_OPT_LEVEL=1 CARGO_PROFILE_DEV_DEBUG=line-tables-only \
  CARGO_PROFILE_DEV_DEBUG_ASSERTIONS=false CARGO_PROFILE_DEV_OVERFLOW_CHECKS=false RUSTFLAGS="-Zsanitizer=$kind" \
  cargo +nightly build -Zbuild-std=std,panic_unwind --target $target --lib --locked --target-dir "$build"

# Link the sanitizer's run-time library of the Rust toolchain into the programs, where the instrumented library finds
# it.
runtime="$(ls "$(rustc +nightly --print sysroot)/lib/rustlib/$target/lib/"librustc-*_rt.$runtime.a)"
library="$build/$target/debug"
ln -sf libluxfer.so "$library/$(readelf -d "$library/libluxfer.so" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')"
run() { # name, source, arguments...
  name="$1" source="$2"
  shift 2
  case "$source" in *.c) compile="clang -std=c99 -D_POSIX_C_SOURCE=199309L" ;; *) compile="clang++ -std=c++17" ;; esac
  $compile -O1 -g -fsanitize="$kind" -Iinclude -Ibindings/cpp -c "$source" -o "$build/$name.o"
  clang++ "$build/$name.o" -o "$build/$name" -Wl,--whole-archive "$runtime" -Wl,--no-whole-archive -rdynamic \
    -L"$library" -lluxfer -Wl,-rpath,"$library" -lpthread -ldl -lrt -lm
  mkdir -p "$build/work/$name"
  (cd "$build/work/$name" && TSAN_OPTIONS=exitcode=66 ASAN_OPTIONS=exitcode=66:detect_leaks=1 "$build/$name" "$@")
}

# First check that the sanitizer detects errors: a host that writes pixels while the library reads them, and a host
# that has fewer pixels than it states.
cat >"$build/thread.cpp" <<'END'
#include <luxfer.hpp>
#include <thread>
#include <vector>
int main() {
    const auto context = luxfer::Context::create();
    std::vector<float> pixels(64 * 64 * 3, 0.5f);
    std::thread host([&pixels] { for (int i = 0; i < 200; ++i) for (float &v : pixels) v += 1; });
    for (int i = 0; i < 200; ++i) luxfer::Image::create(context, {pixels, 64, 64});
    host.join();
}
END
cat >"$build/address.cpp" <<'END'
#include <luxfer.hpp>
#include <vector>
int main() {
    const auto context = luxfer::Context::create();
    std::vector<float> pixels(64 * 64 * 3 - 1, 0.5f);
    luxfer_image_view view;
    luxfer_image_view_init(&view, sizeof view);
    view.width = view.height = 64;
    view.byte_size = 64 * 64 * 3 * sizeof(float);
    view.data = pixels.data();
    luxfer_image *image = nullptr;
    luxfer_image_create(context.get(), &view, &image);
    luxfer_release(image);
}
END
if run seen "$build/$kind.cpp" >"$build/seen.log" 2>&1 || ! grep -Eq "data race|heap-buffer-overflow" "$build/seen.log"; then
  cat "$build/seen.log" >&2
  echo "the mistake that there is was not found" >&2
  exit 1
fi

for harness in $harnesses; do
  run "$harness" "tests/cpp/$harness.cpp"
done
for example in $examples; do
  name="$(basename "$example" .c)"
  case "$name" in # as in CMakeLists.txt
    lighting_transfer) run "$name" "examples_c/$name.c" --samples 4 --size 320x180 ;;
    stylize) run "$name" "examples_c/$name.c" --samples 4 --size 160x120 ;;
    *) run "$name" "examples_c/$name.c" ;;
  esac
done
echo "$kind: nothing found"
