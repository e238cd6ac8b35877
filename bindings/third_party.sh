#!/bin/sh
# Prints the crates that are linked into the library and their licence texts, for everyone who distributes the library.
set -eu
cd "$(dirname "$0")/.."
sources="${CARGO_HOME:-$HOME/.cargo}/registry/src"

crates="$("${CARGO:-cargo}" tree --locked --edges normal --prefix none --format '{p}|{l}' | sed 's/ (\*)$//; s/ (proc-macro)//' | sort -u)"
echo "libluxfer is built with these packages, and contains the Rust standard library (MIT OR Apache-2.0):"
echo
echo "$crates" | grep -v '^luxfer ' | sed 's/|/: /; s/^/  /'
echo "$crates" | grep -v '^luxfer ' | while IFS='|' read -r crate licence; do
  folder="$(echo "$crate" | sed 's/ v/-/; s/ .*//')"
  printf '\n==== %s (%s)\n' "$crate" "$licence"
  for file in "$sources"/*/"$folder"/LICEN[CS]E* "$sources"/*/"$folder"/COPYING* "$sources"/*/"$folder"/NOTICE*; do
    [ -f "$file" ] || continue
    printf '\n---- %s\n\n' "$(basename "$file")"
    cat "$file"
  done
done
