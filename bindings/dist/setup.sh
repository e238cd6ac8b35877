#!/bin/sh
# Installs what the packages for other platforms need: Debian packages (compilers and emulators, with which the packages
# are tested), zig and cargo-zigbuild from PyPI (the linkers), and Rust's standard library for each target.
set -eu
cd "$(dirname "$0")/../.."
packages="gcc-aarch64-linux-gnu g++-aarch64-linux-gnu gcc-mingw-w64-x86-64-posix g++-mingw-w64-x86-64-posix qemu-user wine64
  cmake pkg-config python3-venv"
targets="aarch64-unknown-linux-gnu x86_64-unknown-linux-musl x86_64-pc-windows-gnu aarch64-apple-darwin x86_64-apple-darwin"

missing=""
for package in $packages; do dpkg -s "$package" >/dev/null 2>&1 || missing="$missing $package"; done
if [ -n "$missing" ]; then
  root=""
  [ "$(id -u)" = 0 ] || root="sudo -n"
  command -v apt-get >/dev/null || { echo "there is no apt-get here; install these first:$missing" >&2; exit 1; }
  $root apt-get update -qq </dev/null
  $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing </dev/null
fi

# zig is a C compiler and linker for all targets; auditwheel and numpy are for the wheels.
if [ ! -x target/peers/dist/bin/cargo-zigbuild ]; then
  python3 -m venv target/peers/dist
  target/peers/dist/bin/pip --disable-pip-version-check --quiet install ziglang cargo-zigbuild auditwheel numpy 'setuptools>=70.1' ||
    { rm -rf target/peers/dist; exit 1; }
fi
# The libraries that zig compiles while it links name this folder in their debug symbols, whichever Python is used.
ln -sfn "$(cd target/peers/dist && echo lib/python3*/site-packages/ziglang/lib)" target/peers/dist/zig

if command -v rustup >/dev/null; then
  installed="$(rustup target list --installed)"
  for target in $targets; do
    echo "$installed" | grep -qx "$target" || rustup target add "$target"
  done
else
  echo "without rustup, install Rust's standard library for these targets yourself: $targets" >&2
fi
