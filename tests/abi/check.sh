#!/bin/sh
# Compares the functions, structs and constants of the header with those recorded for this minor version: functions and
# structs (baseline.abi) by abidiff, the names and values of #defined constants (baseline.constants) by this script,
# because debug information does not contain them. Functions and constants may be added, but existing ones may neither
# change nor disappear. abidw cannot read the debug information of Rust, so the check compiles a C library of empty
# functions from the header and analyses that.
#
#   check.sh SOURCE WORK            checks; exits with 77 if abidiff is not installed
#   check.sh SOURCE WORK --record   records the present functions, structs and constants: for a new minor version, or
#                                   after a struct has grown at its end
set -eu
source="$1" work="$2" record="${3:-}"
command -v abidiff >/dev/null && command -v abidw >/dev/null || exit 77
mkdir -p "$work"
cd "$work"
export LC_ALL=C

# List the constants with their values. The version is not one of them, and include guards have no value.
cat "$source"/include/luxfer.h "$source"/include/luxfer/*.h | sed -nE 's/^#define (LUXFER_[A-Z0-9_]+) (.*[^ ]) *$/\1 \2/p' |
  grep -vE '^LUXFER_VERSION(_MAJOR|_MINOR|_PATCH)? ' | sort >now.constants

# Write an empty body for every function that the header declares.
{
  echo '#include <luxfer.h>'
  echo '#include <luxfer.h>' | cc -E -P -DLUXFER_NO_DEPRECATED -x c -I"$source/include" - | tr '\n' ' ' | sed 's/; */;\n/g; s/} */}\n/g' |
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
  cp now.constants "$source/tests/abi/baseline.constants"
  exit
fi
comm -23 "$source/tests/abi/baseline.constants" now.constants >missing.constants
if [ -s missing.constants ]; then
  echo "constants that are gone or have another value now; as recorded:" >&2
  cat missing.constants >&2
  exit 1
fi
abidiff --no-added-syms --no-corpus-path "$source/tests/abi/baseline.abi" now.abi
echo "abi: $declared functions, $(wc -l <now.constants) constants; nothing that was recorded has changed"
