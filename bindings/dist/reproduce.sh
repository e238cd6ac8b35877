#!/bin/sh
# Builds the packages of a target twice, from copies of the last commit in two folders, for two users (HOME, USER,
# umask) with linkers and crates of their own, and compares all files.
#
#   reproduce.sh TARGET    see targets.sh; prints the checksums, and fails if any differ
set -eu
target="$1"
. "$(dirname "$0")/targets.sh"
work="$root/target/dist/reproduce"
rustup="${RUSTUP_HOME:-$HOME/.rustup}"
rm -rf "$work"

# make_in FOLDER USER UMASK: the packages lie in FOLDER/out/dist.
make_in() {
  umask "$3"
  mkdir -p "$1" "$work/home/$2"
  git -C "$root" archive HEAD | tar -x -C "$1"
  # The toolchains are shared, and so is the time of the last commit (targets.sh).
  (cd "$1" && env -u CARGO_HOME -u CARGO_TARGET_DIR HOME="$work/home/$2" USER="$2" LOGNAME="$2" RUSTUP_HOME="$rustup" make --no-print-directory "dist-$target")
  (cd "$1/out/dist" && sha256sum -- luxfer*-*) >"$work/$2.txt"
}

make_in "$work/one" anne 022
make_in "$work/another/folder/two" bob 077
cat "$work/anne.txt"
diff "$work/anne.txt" "$work/bob.txt" || fail "the packages of the two builds differ: compare the files in $work"
[ "$(wc -l <"$work/anne.txt")" -ge 1 ] || fail "no packages"
echo "$target: two builds in different folders and for different users gave equal files"
rm -rf "$work"
