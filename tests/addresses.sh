#!/bin/sh
# AddressSanitizer over the library, the standard library under it, the harnesses of the C ABI that need no other library, and the C
# examples; and leaks. By hand, as tests/threads.sh is: it needs a nightly toolchain with rust-src, clang, and a quarter of an hour.
#
#   tests/addresses.sh [HARNESS...]     those of tests/cpp, without the examples; default: all of those, and the examples
set -eu
cd "$(dirname "$0")/.."
target=x86_64-unknown-linux-gnu
build="$PWD/target/addresses"
examples=
[ $# -gt 0 ] || examples="$(cd examples_c && ls ./*.c)"
harnesses="${*:-abi_contract bad_input host stylisation wrapper wrapper_stages}"

# As users have it, without the assertions of debugging.
CARGO_INCREMENTAL=0 CARGO_PROFILE_DEV_OPT_LEVEL=1 CARGO_PROFILE_DEV_DEBUG=line-tables-only \
  CARGO_PROFILE_DEV_DEBUG_ASSERTIONS=false CARGO_PROFILE_DEV_OVERFLOW_CHECKS=false RUSTFLAGS="-Zsanitizer=address" \
  cargo +nightly build -Zbuild-std=std,panic_unwind --target $target --lib --locked --target-dir "$build"

# The programs have the toolchain's run-time library, which the instrumented library finds in them.
runtime="$(ls "$(rustc +nightly --print sysroot)/lib/rustlib/$target/lib/"librustc-*_rt.asan.a)"
library="$build/$target/debug"
ln -sf libluxfer.so "$library/$(readelf -d "$library/libluxfer.so" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')"
run() { # name, source, arguments...
  name="$1" source="$2"
  shift 2
  case "$source" in *.c) compile="clang -std=c99 -D_POSIX_C_SOURCE=199309L" ;; *) compile="clang++ -std=c++17" ;; esac
  $compile -O1 -g -fsanitize=address -Iinclude -Ibindings/cpp -c "$source" -o "$build/$name.o"
  clang++ "$build/$name.o" -o "$build/$name" -Wl,--whole-archive "$runtime" -Wl,--no-whole-archive -rdynamic \
    -L"$library" -lluxfer -Wl,-rpath,"$library" -lpthread -ldl -lrt -lm
  mkdir -p "$build/work/$name"
  (cd "$build/work/$name" && ASAN_OPTIONS=exitcode=66:detect_leaks=1 "$build/$name" "$@")
}

# Can it see anything at all? A host that has fewer pixels than it says.
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
    luxfer_image_release(image);
}
END
if run seen "$build/address.cpp" >"$build/seen.log" 2>&1 || ! grep -q heap-buffer-overflow "$build/seen.log"; then
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
echo "addresses: nothing found"
