#!/bin/sh
# Builds the library for a target and packs it.
#
#   pack.sh TARGET    see targets.sh; writes into out/dist
#
#   luxfer-VERSION-TARGET.tar.gz (.zip)   the library without debug symbols, headers, CMake package, luxfer.pc,
#                                         licences, SBOM
#   luxfer-VERSION-TARGET-debug.tar.gz    the debug symbols: unpack it over the archive, where debuggers find them
#   luxfer-VERSION-py3-none-*.whl         the Python package with the library inside
#   luxfer_lighting-VERSION-*.zip         the Blender extension with the wheel inside, where Blender itself exists
set -eu
target="$1"
. "$(dirname "$0")/targets.sh"
cd "$root"
CARGO="${CARGO:-cargo}"

# Cargo's folders and the source tree must not be named in the library: see the Makefile.
build() {
  RUSTFLAGS="--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo --remap-path-prefix=$root=luxfer"
  case "$target" in
    # The time of linking would be in the library. Unwinding comes from the compiler's static library, so that the DLL
    # needs nothing but Windows.
    windows-*) RUSTFLAGS="$RUSTFLAGS -C link-arg=-Wl,--no-insert-timestamp -C link-arg=-static-libgcc" ;;
  esac
  export RUSTFLAGS
  case "$target" in
    windows-*)
      # Rust's own copies of MinGW's files are used; only the linker is Debian's.
      CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER=x86_64-w64-mingw32-gcc-posix \
        "$CARGO" build --release --lib --locked --target "$triple" --target-dir target/dist
      ;;
    *) "$CARGO" zigbuild --release --lib --locked --target "$triple.$glibc" --target-dir target/dist ;;
  esac
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
}

# fill TEMPLATE FILE [SED-OPTIONS...]: fills in a template, as bindings/install.mk does.
fill() {
  template="$1" file="$2"
  shift 2
  abi="$(echo "$version" | sed -E 's/^(0\.[0-9]+|[1-9][0-9]*)\..*/\1/')"
  sed -e "s|@VERSION@|$version|g" -e "s|@ABI@|$abi|g" "$@" "$template" >"$file"
}

# Windows: the DLL in bin, where programs and Windows look for it; one import library for MinGW, one for MSVC.
stage_windows() {
  mkdir -p "$top/bin" "$top/include/luxfer" "$top/lib/pkgconfig" "$top/lib/cmake/luxfer" "$top/share/doc/luxfer"
  cp include/luxfer.h bindings/cpp/luxfer.hpp "$top/include"
  cp include/luxfer/*.h bindings/cpp/luxfer/*.hpp "$top/include/luxfer"
  cp LICENSE-APACHE LICENSE-MIT README.md "$top/share/doc/luxfer"
  CARGO="$CARGO" CARGO_BUILD_TARGET="$triple" bindings/third_party.sh >"$top/share/doc/luxfer/THIRD-PARTY.txt"
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
  fill bindings/pkgconfig/luxfer.pc.in "$top/lib/pkgconfig/luxfer.pc" -e 's|@INCLUDEDIR@|../../include|' -e '/^#.*native-static-libs/d' -e '/^Libs.private/d'
  fill bindings/dist/luxferConfig-windows.cmake.in "$top/lib/cmake/luxfer/luxferConfig.cmake"
  fill bindings/cmake/luxferConfigVersion.cmake.in "$top/lib/cmake/luxfer/luxferConfigVersion.cmake"
}

# The Python package with the staged library. It is built in a copy, because setuptools would put what it built for one
# target into the wheel of the next.
wheel() {
  copy="$stage/wheel"
  rm -rf "$copy"
  mkdir -p "$copy/bindings" "$copy/include/luxfer"
  cp -RL bindings/python "$copy/bindings"
  rm -rf "$copy/bindings/python/build"
  find "$copy" -name __pycache__ -prune -exec rm -rf {} +
  cp include/luxfer/core.h "$copy/include/luxfer"
  cp "$top/share/doc/luxfer/THIRD-PARTY.txt" "$top/share/doc/luxfer/luxfer.cdx.json" "$copy/bindings/python/luxfer"
  LUXFER_WHEEL_LIBRARY="$1" python -m pip --disable-pip-version-check --quiet wheel --no-deps --no-build-isolation \
    --config-settings="--build-option=--plat-name=$tag" --wheel-dir "$out" "$copy/bindings/python"
}

step "library"
build

step "archive"
top="$stage/$name"
rm -rf "$stage"
mkdir -p "$top" "$out"
rm -f "$out/$name".* "$out/$name-debug".*
rm -f "$out"/luxfer-*-"$tag".whl "$out"/luxfer_lighting-*-"${blender:-none}".zip
case "$target" in
  windows-*) stage_windows ;;
  *) stage_linux ;;
esac
python bindings/dist/sbom.py "$triple" >"$top/share/doc/luxfer/luxfer.cdx.json"
python bindings/dist/archive.py "$top" "$out/$name.$archive"
[ ! -d "$top-debug" ] || {
  mkdir -p "$stage/debug"
  mv "$top-debug" "$stage/debug/$name"
  python bindings/dist/archive.py "$stage/debug/$name" "$out/$name-debug.tar.gz"
}

step "wheel"
wheel "$(find "$top" -name "$library" -type f -o -name "$library.*.*.*" -type f)"

[ -z "$blender" ] || {
  step "Blender extension"
  python bindings/blender/build.py "$out" --wheel "$out/luxfer-$version-py3-none-$tag.whl"
}
