#!/bin/sh
# Compares the functions and structs of the header with those recorded for this minor version (baseline.abi), by
# abidiff. Functions may be added, but existing ones may neither change nor disappear. abidw cannot read the debug
# information of Rust, so the check compiles a C library of empty functions from the header and analyses that.
#
#   check.sh SOURCE WORK            checks; exits with 77 if abidiff is not installed
#   check.sh SOURCE WORK --record   records the present functions and structs: for a new minor version, or after a
#                                   struct has grown at its end
set -eu
source="$1" work="$2" record="${3:-}"
command -v abidiff >/dev/null && command -v abidw >/dev/null || exit 77
mkdir -p "$work"
cd "$work"

# Write an empty body for every function that the header declares.
{
  echo '#include <luxfer.h>'
  echo '#include <luxfer.h>' | cc -E -P -x c -I"$source/include" - | tr '\n' ' ' | sed 's/; */;\n/g; s/} */}\n/g' |
    grep -E '^(luxfer_status|const char \*|uint32_t|double|float|void) ?luxfer_[a-z0-9_]+\([^{]*\);$' |
    sed -E 's/^(void .*);$/\1 {}/; s/;$/ { return 0; }/'
} >functions.c
cc -std=c99 -g -O0 -shared -fPIC -Wno-unused-parameter -I"$source/include" functions.c -o functions.so

# Check that no function was missed: the bodies are as many as the declarations that are not inline.
declared="$(grep -c 'luxfer_[a-z0-9_]*(.*[{]' functions.c)"
wanted="$(cat "$source"/include/luxfer.h "$source"/include/luxfer/*.h | grep -cE '^[a-z].* \*?luxfer_[a-z0-9_]+\(')"
inline="$(cat "$source"/include/luxfer.h "$source"/include/luxfer/*.h | grep -cE '^static inline .*luxfer_[a-z0-9_]+\(' || true)"
if [ "$declared" -ne "$((wanted - inline))" ]; then
  echo "$declared functions of $((wanted - inline)) that the header declares have a body" >&2
  exit 1
fi

abidw --headers-dir "$source/include" --no-show-locs --no-comp-dir-path --no-corpus-path --no-elf-needed \
  --drop-undefined-syms functions.so >now.abi
if [ "$record" = --record ]; then
  cp now.abi "$source/tests/abi/baseline.abi"
  exit
fi
abidiff --no-added-syms --no-corpus-path "$source/tests/abi/baseline.abi" now.abi
echo "abi: $declared functions; nothing that was recorded has changed"
