#!/bin/sh
# Installs luxfer into a scratch folder and builds programs against it: by pkg-config, by find_package, again after the
# installed tree has been moved, and with the source tree as a part of their project. Checks that uninstalling leaves
# nothing behind, and that the tarball of `make dist` is complete and installs the same files.
#
#   check.sh SOURCE BUILT SCRATCH    BUILT is the folder with cargo's libluxfer.so and libluxfer.a
set -eu
source="$1" built="$2" scratch="$3"
consumers="$source/tests/package"
flags="-O1 -Wall -Wextra -Wpedantic -Werror"
rm -rf "$scratch"
mkdir -p "$scratch"
cd "$scratch"
version="$(sed -n '/^version = /{s/.*"\(.*\)"/\1/p;q;}' "$source/Cargo.toml")"
abi="$(echo "$version" | sed -E 's/^(0\.[0-9]+|[1-9][0-9]*)\..*/\1/')"

step() { echo "== $1"; }

fail() {
  echo "failed: $1" >&2
  exit 1
}

run_make() { make --no-print-directory -s -C "$source" PROFILE="$built" "$@"; }

# check_tree PREFIX: checks the installed files under a prefix.
check_tree() {
  for link in libluxfer.so "libluxfer.so.$abi"; do
    [ -L "$1/$lib/$link" ] || fail "$link is no symbolic link"
  done
  [ "$(readlink -f "$1/$lib/libluxfer.so")" = "$1/$lib/libluxfer.so.$version" ] || fail "libluxfer.so leads elsewhere"
  readelf -d "$1/$lib/libluxfer.so" | grep -q "SONAME.*\[libluxfer.so.$abi\]" || fail "wrong SONAME"
  for file in include/luxfer.h include/luxfer/core.h include/luxfer.hpp include/luxfer/core.hpp "$lib/libluxfer.a" share/doc/luxfer/LICENSE-MIT \
    share/doc/luxfer/THIRD-PARTY.txt; do
    [ -s "$1/$file" ] || fail "$file is not there, or empty"
  done
}

# Runs the command line, which finds its package and the library from its own place. Most of it needs numpy.
run_luxfer() {
  [ "$("$1/bin/luxfer" --version)" = "luxfer $version" ] || fail "luxfer --version"
  "$1/bin/luxfer" --help | grep -q transfer || fail "luxfer --help"
  if python3 -c 'import numpy' 2>/dev/null; then
    "$1/bin/luxfer" surfaces demo:target-room | grep -q Ceiling || fail "luxfer surfaces"
  else
    "$1/bin/luxfer" surfaces demo:target-room 2>&1 | grep -q "numpy is not installed" || fail "luxfer without numpy"
  fi
}

# Builds programs in C and C++ against the shared and the static library, with the flags of pkg-config.
by_pkg_config() {
  export PKG_CONFIG_PATH="$1/pkgconfig"
  pkg-config --exact-version="$version" luxfer || fail "pkg-config does not find luxfer $version"
  cflags="$(pkg-config --cflags luxfer)"
  cc -std=c99 $flags $cflags "$consumers/consumer.c" -o by_c $(pkg-config --libs luxfer)
  c++ -std=c++17 $flags $cflags "$consumers/consumer.cpp" -o by_cpp $(pkg-config --libs luxfer)
  readelf -d by_c | grep -q "NEEDED.*\[libluxfer.so.$abi\]" || fail "the program needs another library"
  LD_LIBRARY_PATH="$1" ./by_c
  LD_LIBRARY_PATH="$1" ./by_cpp
}

by_pkg_config_static() {
  # Link with the libraries that `pkg-config --static` lists; -l:libluxfer.a selects the static library if both are
  # installed.
  cc -std=c99 $flags $cflags "$consumers/consumer.c" -o by_c_static \
    $(pkg-config --static --libs luxfer | sed 's/-lluxfer/-l:libluxfer.a/')
  readelf -d by_c_static | grep -q libluxfer && fail "the program is not linked statically"
  ./by_c_static
}

# Checks that names in the static library cannot clash with others: besides luxfer_* it has only the names of Rust and
# of its crates (mangled, or with a version) and of the compiler. A plug-in that contains the library exports only its
# own functions.
names_of_static() {
  nm --extern-only --defined-only "$1/libluxfer.a" 2>/dev/null | awk 'NF == 3 { print $3 }' | sort -u >names
  [ "$(grep -c '^luxfer_' names)" -gt 100 ] || fail "the static library lacks functions"
  others="$(grep -vE '^(luxfer_|_R|_ZN|__|anon\.|rust_|DW\.ref\.rust_|libpulp_v[0-9])' names || true)"
  [ -z "$others" ] || fail "names that may clash: $others"
  cc -std=c99 $flags -fPIC -shared $cflags "$consumers/plugin.c" -o plugin.so -Wl,--exclude-libs,ALL \
    $(pkg-config --static --libs luxfer | sed 's/-lluxfer/-l:libluxfer.a/')
  exports="$(nm -D --extern-only --defined-only plugin.so | awk '{ print $3 }' | xargs)"
  [ "$exports" = plugin_start ] || fail "the plug-in exports more than its own: $exports"
}

# by_cmake FOLDER OPTIONS...: builds the programs by CMake.
by_cmake() {
  folder="$1"
  shift
  cmake -S "$consumers" -B "$folder" -DCMAKE_BUILD_TYPE=Release -DVERSION="$version" "$@" >"$folder.log" 2>&1 || { cat "$folder.log"; fail "cmake"; }
  cmake --build "$folder" >>"$folder.log" 2>&1 || { cat "$folder.log"; fail "cmake --build"; }
  (cd "$folder" && ctest --output-on-failure)
}

step "install"
# Use Debian's folder for libraries where the compiler has one; the staged installation below uses plain lib.
triplet="$(cc -print-multiarch 2>/dev/null || true)"
lib="lib${triplet:+/$triplet}"
into="PREFIX=$scratch/prefix LIBDIR=$scratch/prefix/$lib"
run_make install $into
check_tree "$scratch/prefix"
run_luxfer "$scratch/prefix"

step "pkg-config"
by_pkg_config "$scratch/prefix/$lib"
by_pkg_config_static
names_of_static "$scratch/prefix/$lib"
step "a program of 0.1"
"$source/tests/abi/old_program.sh" "$source" "$scratch/prefix/$lib" "$scratch/old_program"
step "find_package"
by_cmake found -DCMAKE_PREFIX_PATH="$scratch/prefix"

step "moved"
mv prefix moved
run_luxfer "$scratch/moved"
by_pkg_config "$scratch/moved/$lib"
by_cmake moved_build -DLIBRARIES=luxfer -DCMAKE_PREFIX_PATH="$scratch/moved"
mv moved prefix

step "FetchContent and add_subdirectory"
by_cmake part -DLIBRARIES=luxfer -DLUXFER_SOURCE="$source" -DLUXFER_LIB_DIR="$built"

step "debug symbols"
cd "prefix/$lib"
readelf -S libluxfer.so | grep -q '\.gnu_debuglink' || fail "the library does not name its debug symbols"
for file in libluxfer.so libluxfer.a; do
  readelf -S "$file" 2>/dev/null | grep -q '\.debug_line' && fail "$file still has debug symbols"
done
readelf -S .debug/libluxfer.so.*.debug | grep -q '\.debug_line' || fail "the debug symbols are lost"
readelf -S libluxfer.so | grep -q '\.symtab' && fail "libluxfer.so still has its symbol table"
readelf -S .debug/libluxfer.so.*.debug | grep -q '\.symtab' || fail "the symbol table is lost"
# All names by which programs link are left.
nm -D --defined-only --format=posix libluxfer.so | cut -d' ' -f1 | sort >"$scratch/installed.names"
nm -D --defined-only --format=posix "$built/libluxfer.so" | cut -d' ' -f1 | sort >"$scratch/built.names"
[ "$(grep -c '^luxfer_' "$scratch/installed.names")" -gt 100 ] || fail "the library lacks functions"
cmp "$scratch/built.names" "$scratch/installed.names" || fail "the library exports other names than the built one"

step "no folders of this machine"
# The libraries must name neither cargo's folder of dependencies nor the source tree. Those built by cargo alone name
# both.
for file in libluxfer.so libluxfer.a .debug/libluxfer.so.*.debug; do
  for folder in "${CARGO_HOME:-$HOME/.cargo}" "$source/src"; do
    grep -q "$folder" "$file" && fail "$file names $folder; build it by make or CMake"
  done
done
cd "$scratch"

step "uninstall"
run_make uninstall $into
left="$(find prefix ! -type d; find prefix -path '*/luxfer*')"
[ -z "$left" ] || fail "left behind: $left"

step "as built"
run_make install DEBUG=keep $into
cmp "$built/libluxfer.so" "prefix/$lib/libluxfer.so" || fail "the library is not as built"
[ ! -e "prefix/$lib/.debug" ] || fail "debug symbols were split"
run_make uninstall $into

step "DESTDIR"
run_make install DESTDIR="$scratch/stage" PREFIX=/usr
[ -f stage/usr/lib/libluxfer.a ] || fail "nothing in stage/usr/lib"
grep -r "$scratch" stage/usr/lib/pkgconfig stage/usr/lib/cmake stage/usr/bin && fail "installed files name the folder they were staged in"

if [ -e "$source/.git" ]; then # the tarball contains the files that git tracks
  step "dist"
  run_make dist
  tar -xzf "$source/out/luxfer-$version.tar.gz"
  (cd "luxfer-$version" && find . ! -type d | sed 's|^./||' | sort) >packed
  git -C "$source" ls-tree -r --name-only HEAD | sort | cmp - packed || fail "the tarball is not the last commit"
  make --no-print-directory -s -C "luxfer-$version" PROFILE="$built" install DESTDIR="$scratch/dist" PREFIX=/usr
  # npm builds the page of the studio in the source tree; the tarball holds its sources.
  installed() { (cd "$1" && find . ! -path '*/luxfer/studio/static*') | sort; }
  installed stage >staged
  installed dist | cmp - staged || fail "the tarball installs something else"
fi
rm -rf "$scratch"
echo "package: all checks passed"
