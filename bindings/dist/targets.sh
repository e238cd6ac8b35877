# Sourced by pack.sh and check.sh: sets for the target $target
#
#   triple        the target as Rust names it; for macOS, two of them
#   crates        the kinds of libraries that are built
#   library       the file name of the library
#   archive       the ending of the archive
#   tag           the platform tag of the Python wheel; empty: there is no wheel, because the library is static
#   blender       the platform as Blender names it; empty: there is no Blender for it
#   prefix        the prefix of the GNU tools for it (objcopy, gcc)
#   emulator      the command that runs its programs here; empty: none is needed
root="$(cd "$(dirname "$0")/../.." && pwd)"
version="$(sed -n '/^version = /{s/.*"\(.*\)"/\1/p;q;}' "$root/Cargo.toml")"
# The ending of the SONAME, as in the Makefile.
abi="$(echo "$version" | sed -E 's/^(0\.[0-9]+|[1-9][0-9]*)\..*/\1/')"
# The oldest glibc on which the Linux libraries run: the one of manylinux2014, and the oldest that Rust supports.
glibc=2.17
emulator="" blender="" archive=tar.gz library=libluxfer.so
crates=cdylib,staticlib
case "$target" in
  linux-x86_64)
    triple=x86_64-unknown-linux-gnu prefix="" tag=manylinux_2_17_x86_64 blender=linux-x64
    ;;
  linux-aarch64)
    triple=aarch64-unknown-linux-gnu prefix=aarch64-linux-gnu- tag=manylinux_2_17_aarch64
    emulator="qemu-aarch64 -L /usr/aarch64-linux-gnu"
    ;;
  linux-musl-x86_64)
    triple=x86_64-unknown-linux-musl prefix="" tag="" library=libluxfer.a crates=staticlib
    ;;
  windows-x86_64)
    triple=x86_64-pc-windows-gnu prefix=x86_64-w64-mingw32- tag=win_amd64 blender=windows-x64 archive=zip library=luxfer.dll
    crates=cdylib
    # Debian keeps it out of PATH where the package `wine` is not installed too.
    emulator="$(command -v wine64 || echo /usr/lib/wine/wine64)"
    ;;
  macos-universal)
    # Two builds, joined into one library. The tools of GNU know no Mach-O, so its debug symbols are left out.
    triple="aarch64-apple-darwin x86_64-apple-darwin" prefix="" tag=macosx_11_0_universal2 library=libluxfer.dylib
    crates=cdylib
    ;;
  *)
    echo "no target $target" >&2
    exit 2
    ;;
esac
# What cargo has built, the folder to be packed, and the folder of the packages.
built="$root/target/dist/${triple%% *}/dist"
name="luxfer-$version-$target"
stage="$root/target/dist/stage/$target"
out="$root/out/dist"
# The time of all files in the packages, so that equal sources give equal packages: that of the last commit.
SOURCE_DATE_EPOCH="${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 1735689600)}"
export SOURCE_DATE_EPOCH
PATH="$root/target/peers/dist/bin:$PATH"
export PATH

step() { echo "== $target: $1"; }

fail() {
  echo "failed: $1" >&2
  exit 1
}
