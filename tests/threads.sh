#!/bin/sh
# ThreadSanitizer over the library, the standard library under it, and the harnesses of the C ABI that use threads. By hand: it needs
# a nightly toolchain with rust-src (rustup component add rust-src --toolchain nightly), clang++, and a quarter of an hour.
#
#   tests/threads.sh [HARNESS...]     those of tests/cpp; default abi_contract host wrapper_stages
set -eu
cd "$(dirname "$0")/.."
target=x86_64-unknown-linux-gnu
build=target/threads
harnesses="${*:-abi_contract host wrapper_stages}"

# As users have it, without the assertions of debugging.
CARGO_INCREMENTAL=0 CARGO_PROFILE_DEV_OPT_LEVEL=1 CARGO_PROFILE_DEV_DEBUG=line-tables-only \
  CARGO_PROFILE_DEV_DEBUG_ASSERTIONS=false CARGO_PROFILE_DEV_OVERFLOW_CHECKS=false RUSTFLAGS="-Zsanitizer=thread" \
  cargo +nightly build -Zbuild-std=std,panic_unwind --target $target --lib --locked --target-dir $build

# The harnesses have the toolchain's run-time library, which the instrumented library finds in them.
runtime="$(ls "$(rustc +nightly --print sysroot)/lib/rustlib/$target/lib/"librustc-*_rt.tsan.a)"
library=$build/$target/debug
ln -sf libluxfer.so "$library/$(readelf -d $library/libluxfer.so | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')"
run() { # name, source
  clang++ -std=c++17 -O1 -g -fsanitize=thread -Iinclude -Ibindings/cpp -c "$2" -o "$build/$1.o"
  clang++ "$build/$1.o" -o "$build/$1" -Wl,--whole-archive "$runtime" -Wl,--no-whole-archive -rdynamic \
    -L$library -lluxfer -Wl,-rpath,"$PWD/$library" -lpthread -ldl -lrt -lm
  (cd $build && TSAN_OPTIONS="exitcode=66" "./$1")
}

# Can it see one at all? A host that writes pixels while the library reads them.
cat >$build/racing.cpp <<'END'
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
if run racing $build/racing.cpp >$build/racing.log 2>&1 || ! grep -q 'data race.*' $build/racing.log; then
  echo "the race that there is was not found" >&2
  exit 1
fi

for harness in $harnesses; do
  run "$harness" "tests/cpp/$harness.cpp"
done
echo "threads: no data race"
