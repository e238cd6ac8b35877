#!/bin/sh
# Unpacks the packages of a target and uses them as a user would: compiles programs against the archive by CMake and
# pkg-config, runs them (emulated, where this machine cannot), installs the wheel, and compares the bits of results with
# those of linux-x86_64, which is therefore to be checked first.
#
#   check.sh TARGET    see targets.sh; writes out/dist/check/TARGET.txt, lines `KEY VALUE` for table.py
set -eu
target="$1"
. "$(dirname "$0")/targets.sh"
package="$out/$name.$archive"
scratch="$root/target/dist/check/$target"
report="$out/check/$target.txt"
flags="-O1 -Wall -Wextra"
functions='(a?(sin|cos|tan)h?|atan2|sincos|exp2?|expm1|log(2|10|1p)?|pow|hypot|cbrt)f?'
[ -e "$package" ] || fail "there is no $package; make dist-$target builds it"

say() { # KEY VALUE
  echo "$1 $2" >>"$report.part"
  echo "$1: $2"
}

# by_zig TARGET [FLAGS...]: makes compilers of zig.
by_zig() {
  export ZIG_GLOBAL_CACHE_DIR="$root/target/dist/zig" ZIG_LOCAL_CACHE_DIR="$root/target/dist/zig"
  for compiler in cc c++; do
    echo "#!/bin/sh
exec '$root/target/peers/dist/bin/python' -m ziglang $compiler -target $* \"\$@\"" >"$scratch/$compiler"
    chmod +x "$scratch/$compiler"
  done
  cc="$scratch/cc" cxx="$scratch/c++"
}

# The compilers for the target, and how its programs find the library.
compilers() {
  cc="${prefix}gcc" cxx="${prefix}g++" system="" exe=""
  case "$target" in
    windows-*)
      cc="${prefix}gcc-posix" cxx="${prefix}g++-posix" system=Windows exe=.exe
      flags="$flags -static-libgcc -static-libstdc++"
      export WINEDEBUG=-all WINEPREFIX="$root/target/dist/wine" WINEPATH="$scratch/run"
      mkdir -p "$scratch/run"
      # Programs in C++ by MinGW need its DLL of threads; luxfer.dll itself does not.
      cp "$top/bin/luxfer.dll" "$($cc -print-file-name=libwinpthread-1.dll)" "$scratch/run"
      "$cc" -shared -O1 "$root/bindings/dist/bcryptprimitives.c" -o "$scratch/run/bcryptprimitives.dll" -ladvapi32
      ;;
    linux-aarch64) system=Linux emulator="$emulator -E LD_LIBRARY_PATH=$top/lib" ;;
    # zig is also a compiler for musl and for macOS. CMake wants compilers without arguments.
    linux-musl-*) by_zig x86_64-linux-musl -static ;;
    macos-*) by_zig aarch64-macos ;;
    *) export LD_LIBRARY_PATH="$top/lib" ;;
  esac
}

# compile SOURCE PROGRAM: by the flags of pkg-config, in C99 or C++17.
compile() {
  case "$1" in *.cpp) compiler="$cxx" standard=c++17 ;; *) compiler="$cc" standard=c99 ;; esac
  $compiler -std=$standard $(pkg-config --cflags luxfer) "$1" -o "$2$exe" $(pkg-config --libs luxfer) $flags $math
}

# The project of tests/package, which finds the package by find_package and runs its programs by ctest.
by_cmake() {
  libraries=luxfer
  [ "$library" != libluxfer.a ] || libraries=luxfer_static
  set -- -DVERSION="$version" -DLIBRARIES="$libraries" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$top" \
    -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx"
  [ -z "$system" ] || set -- "$@" -DCMAKE_SYSTEM_NAME="$system" -DCMAKE_CROSSCOMPILING_EMULATOR="$(echo "$emulator" | tr ' ' ';')" \
    -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=BOTH
  [ "$system" != Windows ] || set -- "$@" -DCMAKE_EXE_LINKER_FLAGS=-static
  cmake -S "$root/tests/package" -B "$scratch/cmake" "$@" >"$scratch/cmake.log" 2>&1 || { cat "$scratch/cmake.log"; fail cmake; }
  cmake --build "$scratch/cmake" >>"$scratch/cmake.log" 2>&1 || { tail -30 "$scratch/cmake.log"; fail "cmake --build"; }
  [ -z "$runs" ] || (cd "$scratch/cmake" && ctest --output-on-failure) || fail ctest
}

# The seed files of the fuzz targets, which the library for this machine writes.
seeds() {
  native="$(find "$root/target/dist/check/linux-x86_64" -name 'libluxfer.so.*.*.*' -type f)"
  [ -n "$native" ] || fail "linux-x86_64 has not been checked"
  LUXFER_LIBRARY="$native" PYTHONPATH="$root/bindings/python" python "$root/fuzz/seeds.py" "$scratch/seeds" >"$scratch/seeds.txt" || fail "fuzz/seeds.py"
}

# Runs one program in a folder of its own, and counts it.
run() { # NAME [ARGUMENTS...]
  program="$1"
  shift
  [ -n "$runs" ] || return 0
  mkdir -p "$scratch/run/$program of $target"
  began="$(date +%s)"
  if (cd "$scratch/run/$program of $target" && $emulator "../$program$exe" "$@" >../"$program.out" 2>../"$program.err"); then
    passed=$((passed + 1))
    echo "$program: passed in $(($(date +%s) - began)) s"
  else
    failed="$failed $program"
    echo "$program: FAILED"
    cat "$scratch/run/$program.err" "$scratch/run/$program.out" | tail -n 8
  fi
  programs=$((programs + 1))
}

# Compares the hashes with those of linux-x86_64, and names those that differ.
compare_bits() {
  cat "$scratch/run/same_bits.out" "$scratch/run/seeds.out" | tr -d '\r' | awk 'NF == 2' >"$out/check/$target.bits"
  cat "$out/check/$target.bits"
  all="$(wc -l <"$out/check/$target.bits")"
  [ "$target" != linux-x86_64 ] || { say same_bits "reference ($all results)"; return 0; }
  [ -s "$out/check/linux-x86_64.bits" ] || { say same_bits "not compared"; return 0; }
  different="$(diff "$out/check/linux-x86_64.bits" "$out/check/$target.bits" | awk '/^>/ { print $2 }' | xargs)"
  count="$(echo "$different" | wc -w)"
  if [ "$count" = 0 ]; then say same_bits "all $all"; else say same_bits "$((all - count)) of $all; different: $(echo "$different" | sed 's/ /, /g')"; fi
}

# Installs the wheel into a clean environment, whose PATH has no compiler, and runs a rendering and the command line.
install_wheel() {
  python3 -m venv "$scratch/clean"
  "$scratch/clean/bin/pip" --disable-pip-version-check --quiet install --only-binary :all: "$1"
  (cd "$scratch" && env -i PATH="$scratch/clean/bin" luxfer surfaces demo:target-room) >"$scratch/surfaces.txt" || fail "luxfer surfaces"
  grep -q Ceiling "$scratch/surfaces.txt" || fail "luxfer surfaces"
}

# The wheel fits the platforms that its name states. Only that of this platform can be installed here.
check_wheel() {
  wheel="$out/luxfer-$version-py3-none-$tag.whl"
  [ -e "$wheel" ] || fail "there is no $wheel"
  case "$target" in
    linux-*)
      python -m auditwheel show "$wheel" 2>&1 | tr '\n' ' ' >"$scratch/auditwheel.txt"
      grep -q 'consistent with the following platform tag: *"manylinux_2_17' "$scratch/auditwheel.txt" || fail "auditwheel: $(cat "$scratch/auditwheel.txt")"
      ;;
  esac
  if [ "$target" = linux-x86_64 ]; then
    install_wheel "$wheel"
    say wheel "installed and run"
  else
    say wheel "built, not run"
  fi
}

# The Blender extension contains the wheel as it is, and says for which platform.
check_extension() {
  extension="$out/luxfer_lighting-$version-$blender.zip"
  [ -e "$extension" ] || fail "there is no $extension"
  python -m zipfile -e "$extension" "$scratch/extension"
  cmp "$wheel" "$scratch/extension/wheels/${wheel##*/}" || fail "the extension contains another wheel"
  grep -qx "platforms = \[\"$blender\"\]" "$scratch/extension/blender_manifest.toml" || fail "the extension is for another platform"
}

# Sines and the like must come from src/maths, because C libraries round them differently. Four remain, in the crates
# that read EXR files compressed by DWA, and that write Radiance files.
only_known_functions() {
  case "$target" in
    *musl*) nm -u --format=posix "$top/lib/libluxfer.a" 2>/dev/null | awk '{ print $1 }' ;;
    *) "${prefix}objdump" -T "$top/lib/libluxfer.so" | awk '/[*]UND[*]/ { print $NF }' ;;
  esac | sort -u | grep -xE "$functions" >"$scratch/functions.txt" || true
  unknown="$(grep -vxE 'cosf|log2f|logf|powf' "$scratch/functions.txt" | xargs)" || true
  [ -z "$unknown" ] || fail "the library calls functions of the C library that round differently elsewhere: $unknown"
}

check_library() {
  case "$target" in
    linux-musl-*)
      say needs "nothing"
      only_known_functions
      ;;
    macos-*)
      python "$root/bindings/dist/universal.py" show "$top/lib/$library" >"$scratch/parts.txt"
      for processor in arm64 x86_64; do
        grep -q "^$processor @rpath/libluxfer.$abi.dylib needs " "$scratch/parts.txt" || fail "$processor is not in $(cat "$scratch/parts.txt")"
      done
      say needs "$(sed 's/.* needs //' "$scratch/parts.txt" | tr ' ' '\n' | sort -u | xargs)"
      ;;
    linux-*64)
      newest="$("${prefix}objdump" -T "$top/lib/libluxfer.so" | grep -o 'GLIBC_[0-9.]*' | sed 's/GLIBC_//' | sort -uV | tail -1)"
      [ "$(printf '%s\n' "$newest" "$glibc" | sort -V | tail -1)" = "$glibc" ] || fail "the library needs glibc $newest"
      say needs "glibc $newest"
      only_known_functions
      python "$root/bindings/dist/auditable.py" "$top/lib/libluxfer.so" >"$scratch/crates.txt" || fail "no list of crates in the library"
      grep -qx "luxfer $version" "$scratch/crates.txt" || fail "luxfer $version is not in $(cat "$scratch/crates.txt")"
      ;;
    windows-*)
      needed="$("${prefix}objdump" -p "$top/bin/luxfer.dll" | sed -n 's/.*DLL Name: //p' | sort -f | xargs)"
      case "$needed" in *libgcc* | *winpthread* | *libstdc*) fail "luxfer.dll needs $needed" ;; esac
      say needs "$needed"
      [ -s "$top/lib/luxfer.lib" ] || fail "no luxfer.lib"
      ;;
  esac
}

mkdir -p "$out/check"
rm -rf "$scratch" "$report.part"
mkdir -p "$scratch/run"
case "$archive" in
  zip) python -m zipfile -e "$package" "$scratch" ;;
  *) tar -xzf "$package" -C "$scratch" ;;
esac
top="$scratch/$name"
step "unpacked"
for file in include/luxfer.h include/luxfer.hpp share/doc/luxfer/LICENSE-MIT share/doc/luxfer/LICENSE-APACHE \
  share/doc/luxfer/THIRD-PARTY.txt share/doc/luxfer/luxfer.cdx.json lib/pkgconfig/luxfer.pc; do
  [ -s "$top/$file" ] || fail "$file is not there, or empty"
done
say target "$target"
say builds yes
size="$(find "$top" \( -name "$library" -o -name 'libluxfer.so.*.*.*' -o -name 'libluxfer.*.dylib' \) -type f ! -path '*.debug*' -exec stat -c %s {} +)"
say bytes "$size"
check_library

compilers
export PKG_CONFIG_LIBDIR="$top/lib/pkgconfig"
math=-lm passed=0 programs=0 failed="" runs=yes
case "$target" in macos-*) runs="" ;; esac
step "seeds"
seeds
step "programs"
# CMake on other systems than macOS refuses libraries with @rpath.
case "$target" in macos-*) ;; *) by_cmake ;; esac
for source in "$root"/tests/dist/*.c "$root"/examples_c/minimal.c "$root"/examples_c/lux_map.c "$root"/tests/package/consumer.cpp \
  "$root"/tests/cpp/abi_contract.cpp "$root"/tests/cpp/bad_input.cpp "$root"/tests/cpp/wrapper.cpp; do
  program="$(basename "$source" | sed 's/\.[^.]*$//')"
  compile "$source" "$scratch/run/$program" || fail "compiling $source"
  case "$program" in same_bits) run same_bits . ;; seeds) run seeds ../../seeds ;; *) run "$program" ;; esac
done
[ -z "$runs" ] || {
  tool="${emulator%% *}" tool="${tool##*/}"
  say runs "${tool:-natively}"
  say passed "$passed of $programs${failed:+, not:$failed}"
  step "bits"
  compare_bits
}

[ -z "$tag" ] || {
  step "wheel"
  check_wheel
}
[ -z "$blender" ] || check_extension
mv "$report.part" "$report"
[ -z "$failed" ] || fail "programs:$failed"
