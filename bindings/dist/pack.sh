#!/bin/sh
# Builds the library for a target and packs it.
#
#   pack.sh TARGET    see targets.sh; writes into out/dist
#
#   luxfer-VERSION-TARGET.tar.gz (.zip)   the library without debug symbols, headers, CMake package, luxfer.pc,
#                                         licences, SBOM
#   luxfer-VERSION-TARGET-debug.tar.gz    the debug symbols: unpack it over the archive, where debuggers find them;
#                                         neither for musl nor for macOS
#   luxfer-VERSION-py3-none-*.whl         the Python package with the library inside; not for musl
#   luxfer_lighting-VERSION-*.zip         the Blender extension with the wheel inside, where Blender itself exists
set -eu
umask 022
target="$1"
. "$(dirname "$0")/targets.sh"
cd "$root"
CARGO="${CARGO:-cargo}"

# build TRIPLE: nothing in the library may depend on where and by whom it is built. Cargo's folders and the source tree
# are not named in it: see the Makefile. The parts of the C library that zig compiles while it links name the folder of
# zig and the current folder. So zig gets the first relative to the second, and the second by a name that all processes
# share.
build() {
  RUSTFLAGS="--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo --remap-path-prefix=$root=luxfer"
  cargo="$CARGO" at=""
  case "$target" in
    # Rust's own copies of MinGW's files are used; only the linker is Debian's. The time of linking would be in the
    # library. Unwinding comes from the compiler's static library, so that the DLL needs nothing but Windows.
    windows-*)
      RUSTFLAGS="$RUSTFLAGS -C link-arg=-Wl,--no-insert-timestamp -C link-arg=-static-libgcc"
      export CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER=x86_64-w64-mingw32-gcc-posix
      ;;
    linux-musl-*) ;;
    macos-*) cargo=cargo-zigbuild CARGO_PROFILE_DIST_DEBUG=none && export CARGO_PROFILE_DIST_DEBUG ;;
    *) cargo=cargo-zigbuild at=".$glibc" ;;
  esac
  export RUSTFLAGS ZIG_LIB_DIR=target/peers/dist/zig ZIG_GLOBAL_CACHE_DIR=target/dist/zig ZIG_LOCAL_CACHE_DIR=target/dist/zig
  env PWD=/proc/self/cwd "$cargo" rustc --profile dist --lib --locked --crate-type "$crates" --target "$1$at" --target-dir target/dist
}

# split LIBRARY SYMBOLS: moves the debug symbols of a library into a file beside it, which the library names.
split() {
  mkdir -p "$(dirname "$2")"
  "${prefix}objcopy" --only-keep-debug "$1" "$2"
  chmod 644 "$2"
  "${prefix}objcopy" --strip-all --add-gnu-debuglink="$2" "$1"
}

# Linux: what `make install` installs.
stage_linux() {
  CARGO_BUILD_TARGET="$triple" make --no-print-directory -s install PROFILE="$built" DESTDIR="$stage" PREFIX="/$name" OBJCOPY="${prefix}objcopy"
  mkdir -p "$top-debug/lib"
  mv "$top/lib/.debug" "$top-debug/lib/.debug"
  # The list of the crates in it, for scanners.
  python bindings/dist/auditable.py "$bill" "$stage/crates"
  "${prefix}objcopy" --add-section .dep-v0="$stage/crates" "$top/lib/libluxfer.so.$version"
}

# fill TEMPLATE FILE [SED-OPTIONS...]: fills in a template, as bindings/install.mk does.
fill() {
  template="$1" file="$2"
  shift 2
  case "$file" in */cmake/*) include=../../../include ;; *) include=../../include ;; esac
  sed -e "s|@VERSION@|$version|g" -e "s|@ABI@|$abi|g" -e "s|@INCLUDEDIR@|$include|g" "$@" "$template" >"$file"
}

# What each archive contains besides the library, where `make install` does not write it.
stage_common() {
  mkdir -p "$top/include/luxfer" "$top/lib/pkgconfig" "$top/lib/cmake/luxfer" "$top/share/doc/luxfer"
  cp include/luxfer.h bindings/cpp/luxfer.hpp "$top/include"
  cp include/luxfer/*.h bindings/cpp/luxfer/*.hpp "$top/include/luxfer"
  cp LICENSE-APACHE LICENSE-MIT README.md "$top/share/doc/luxfer"
  CARGO="$CARGO" CARGO_BUILD_TARGET="${triple%% *}" bindings/third_party.sh >"$top/share/doc/luxfer/THIRD-PARTY.txt"
  fill bindings/pkgconfig/luxfer.pc.in "$top/lib/pkgconfig/luxfer.pc" -e '/^#.*native-static-libs/d' -e '/^Libs.private/d'
  fill bindings/cmake/luxferConfigVersion.cmake.in "$top/lib/cmake/luxfer/luxferConfigVersion.cmake"
}

# Windows: the DLL in bin, where programs and Windows look for it; one import library for MinGW, one for MSVC.
stage_windows() {
  stage_common
  mkdir -p "$top/bin"
  cp "$built/luxfer.dll" "$top/bin"
  (cd "$top/bin" && split luxfer.dll luxfer.dll.debug)
  mkdir -p "$top-debug/bin"
  mv "$top/bin/luxfer.dll.debug" "$top-debug/bin"
  cp "$built/libluxfer.dll.a" "$top/lib"
  {
    echo "LIBRARY luxfer.dll"
    echo "EXPORTS"
    "${prefix}objdump" -p "$top/bin/luxfer.dll" | awk '/\[Ordinal\/Name Pointer\]/ { on = 1; next } on && NF == 0 { exit } on { print $NF }'
  } >"$top/lib/luxfer.def"
  (cd "$top/lib" && python -m ziglang dlltool -m i386:x86-64 -D luxfer.dll -d luxfer.def -l luxfer.lib)
  fill bindings/dist/luxferConfig-windows.cmake.in "$top/lib/cmake/luxfer/luxferConfig.cmake"
}

# musl: the static library alone. All that it needs of the system is in musl's one library.
stage_musl() {
  stage_common
  "${prefix}objcopy" --strip-debug "$built/libluxfer.a" "$top/lib/libluxfer.a"
  fill bindings/dist/luxferConfig-static.cmake.in "$top/lib/cmake/luxfer/luxferConfig.cmake"
}

# macOS: one library with the code for both kinds of processors. Programs find it in the folders of their @rpath.
stage_macos() {
  stage_common
  soname="libluxfer.$abi.dylib"
  python bindings/dist/universal.py join "$top/lib/$soname" $(for one in $triple; do echo "target/dist/$one/dist/$library"; done)
  ln -s "$soname" "$top/lib/$library"
  fill bindings/cmake/luxferConfig.cmake.in "$top/lib/cmake/luxfer/luxferConfig.cmake" -e "s|@LIBRARY@|$soname|g" -e "s|@SONAME@|@rpath/$soname|g"
}

# The Python package with the staged library. It is built in a copy, because setuptools would put what it built for one
# target into the wheel of the next.
wheel() {
  [ -e "$1" ] || fail "no library for the wheel: $1"
  copy="$stage/wheel"
  rm -rf "$copy"
  mkdir -p "$copy/bindings" "$copy/include/luxfer"
  cp -RL bindings/python "$copy/bindings"
  chmod -R u=rwX,go=rX "$copy"
  rm -rf "$copy/bindings/python/build"
  find "$copy" -name __pycache__ -prune -exec rm -rf {} +
  cp include/luxfer/core.h "$copy/include/luxfer"
  cp "$top/share/doc/luxfer/THIRD-PARTY.txt" "$top/share/doc/luxfer/luxfer.cdx.json" "$copy/bindings/python/luxfer"
  LUXFER_WHEEL_LIBRARY="$1" python -m pip --disable-pip-version-check --quiet wheel --no-deps --no-build-isolation \
    --config-settings="--build-option=--plat-name=$tag" --wheel-dir "$out" "$copy/bindings/python"
}

step "library"
for one in $triple; do build "$one"; done

step "archive"
top="$stage/$name"
rm -rf "$stage"
mkdir -p "$top" "$out"
rm -f "$out/$name".* "$out/$name-debug".*
rm -f "$out"/luxfer-*-"${tag:-none}".whl "$out"/luxfer_lighting-*-"${blender:-none}".zip
bill="$stage/luxfer.cdx.json"
python bindings/dist/sbom.py "${triple%% *}" >"$bill"
case "$target" in
  windows-*) stage_windows ;;
  linux-musl-*) stage_musl ;;
  macos-*) stage_macos ;;
  *) stage_linux ;;
esac
cp "$bill" "$top/share/doc/luxfer"
python bindings/dist/archive.py "$top" "$out/$name.$archive"
[ ! -d "$top-debug" ] || {
  mkdir -p "$stage/debug"
  mv "$top-debug" "$stage/debug/$name"
  python bindings/dist/archive.py "$stage/debug/$name" "$out/$name-debug.tar.gz"
}

[ -z "$tag" ] || {
  step "wheel"
  wheel "$(find "$top" -name "$library" ! -path '*/python/*')"
}

[ -z "$blender" ] || {
  step "Blender extension"
  python bindings/blender/build.py "$out" --wheel "$out/luxfer-$version-py3-none-$tag.whl"
}
