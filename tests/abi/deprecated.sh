#!/bin/sh
# Checks LUXFER_DEPRECATED of luxfer/core.h in C and C++, by every compiler that is installed: a call of a marked
# function gives a warning that contains the advice; a declaration alone gives none, and neither does a call where
# LUXFER_NO_DEPRECATED is defined. Checks the attribute of MSVC by its text, because there is no MSVC here.
#
#   deprecated.sh SOURCE WORK
set -eu
source="$1" work="$2"
mkdir -p "$work"
cd "$work"
export LC_ALL=C

fail() {
  echo "failed: $1" >&2
  exit 1
}

cat >declared.c <<'END'
#include <luxfer/core.h>
#ifdef __cplusplus
extern "C" {
#endif
LUXFER_DEPRECATED("use luxfer_new")
luxfer_status luxfer_old(int number);
#ifdef __cplusplus
}
#endif
END
{
  cat declared.c
  echo 'int main(void) { return (int)luxfer_old(1); }'
} >called.c

# accepts COMPILER... FILE: with warnings as errors.
accepts() { "$@" -Wall -Wextra -Wpedantic -Werror -I"$source/include" -fsyntax-only 2>errors.txt; }

checked=0
for compiler in "cc -std=c99" "gcc -std=c99" "clang -std=c99" "c++ -x c++ -std=c++17" "g++ -x c++ -std=c++11" "clang++ -x c++ -std=c++17"; do
  command -v "${compiler%% *}" >/dev/null || continue
  accepts $compiler declared.c || fail "$compiler: a declaration alone gives $(cat errors.txt)"
  accepts $compiler -DLUXFER_NO_DEPRECATED called.c || fail "$compiler: with LUXFER_NO_DEPRECATED $(cat errors.txt)"
  ! accepts $compiler called.c || fail "$compiler: a call gives no warning"
  grep -q "deprecated.*use luxfer_new" errors.txt || fail "$compiler: another warning: $(cat errors.txt)"
  checked=$((checked + 1))
done
[ "$checked" -ge 2 ] || fail "no compiler"

# expands OPTIONS...: the declaration as the compiler sees it; without the system's headers, which name no luxfer_old.
expands() { cc -E -P -x c -std=c99 -I"$source/include" "$@" declared.c 2>/dev/null | tr '\n' ' ' | grep -o '[^;]*luxfer_old([^;]*;' | tr -s ' '; }
expands -U__GNUC__ -U__clang__ -D_MSC_VER=1900 | grep -qF '__declspec(deprecated("use luxfer_new")) luxfer_status luxfer_old(int number);' ||
  fail "for MSVC: $(expands -U__GNUC__ -U__clang__ -D_MSC_VER=1900)"
[ "$(expands -U__GNUC__ -U__clang__ | sed 's/^ //')" = "luxfer_status luxfer_old(int number);" ] ||
  fail "for an unknown compiler: $(expands -U__GNUC__ -U__clang__)"
echo "deprecated: $checked compilers warn and can be told not to"
