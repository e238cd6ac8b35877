#!/bin/sh
# A program that was linked to libluxfer 0.1 does not start with today's library, instead of calling functions whose
# parameters have changed: the loader looks for the SONAME of 0.1, and no file of today's library has that name.
#
#   old_program.sh SOURCE LIBRARIES WORK    LIBRARIES is the folder of the built or installed library
set -eu
source="$1" libraries="$2" work="$3"
rm -rf "$work"
mkdir -p "$work/then" "$work/renamed"
cd "$work"
export LC_ALL=C
unset LD_PRELOAD LD_LIBRARY_PATH

fail() {
  echo "failed: $1" >&2
  exit 1
}

# The declaration of 0.1. Since 0.2 the function has a fifth parameter, to which it writes.
cat >then.h <<'END'
#include <stdint.h>
typedef struct luxfer_job luxfer_job;
int32_t luxfer_job_wait(luxfer_job *job, int32_t timeout_ms, int32_t (*progress)(void *, double), void *user);
END
cat >stub.c <<'END'
#include "then.h"
int32_t luxfer_job_wait(luxfer_job *job, int32_t timeout_ms, int32_t (*progress)(void *, double), void *user) {
    (void)job, (void)timeout_ms, (void)progress, (void)user;
    return 2;
}
END
cat >program.c <<'END'
#include "then.h"
#include <stdio.h>
int main(void) {
    printf("status %d\n", (int)luxfer_job_wait(NULL, -1, NULL, NULL));
    return 0;
}
END
cc -std=c99 -Wall -Wextra -Werror -fPIC -shared stub.c -o then/libluxfer.so.0.1 -Wl,-soname,libluxfer.so.0.1
cc -std=c99 -Wall -Wextra -Werror program.c -o program then/libluxfer.so.0.1
readelf -d program | grep -q 'NEEDED.*\[libluxfer.so.0.1\]' || fail "the program needs another library"

# With the library of its time the program runs.
[ "$(LD_LIBRARY_PATH="$work/then" ./program)" = "status 2" ] || fail "the program does not run with its own library"

# With today's library it does not start. The loader names the library that it did not find.
status=0
LD_LIBRARY_PATH="$libraries" ./program >out.txt 2>err.txt || status=$?
[ "$status" = 127 ] || fail "with today's library the program ends with $status: $(cat out.txt err.txt)"
[ ! -s out.txt ] || fail "the program has run: $(cat out.txt)"
grep -q 'libluxfer.so.0.1: cannot open shared object file' err.txt || fail "another message: $(cat err.txt)"

# The name alone prevents it: today's library under the old name would satisfy the program.
library="$(readlink -f "$libraries/libluxfer.so")"
ln -s "$library" renamed/libluxfer.so.0.1
LD_LIBRARY_PATH="$work/renamed" ldd -r ./program >bound.txt 2>&1 || fail "ldd: $(cat bound.txt)"
grep -q 'libluxfer.so.0.1 => .*/renamed/' bound.txt || fail "the renamed library is not found: $(cat bound.txt)"
! grep -q 'undefined symbol' bound.txt || fail "luxfer_job_wait has gone, so take another function of 0.1: $(cat bound.txt)"
rm -r renamed

# The SONAME is that of the version in Cargo.toml.
abi="$(sed -n '/^version = /{s/.*"\(.*\)"/\1/p;q;}' "$source/Cargo.toml" | sed -E 's/^(0\.[0-9]+|[1-9][0-9]*)\..*/\1/')"
readelf -d "$library" | grep -q "SONAME.*\[libluxfer.so.$abi\]" || fail "the SONAME is not libluxfer.so.$abi"
# A program of 0.1 that loads libluxfer.so by itself checks the version first; the function for it has another name now.
nm -D --defined-only --format=posix "$library" | cut -d' ' -f1 >names.txt
grep -qx luxfer_get_version names.txt || fail "today's library has no luxfer_get_version"
! grep -qx luxfer_version names.txt || fail "today's library has the luxfer_version of 0.1"
echo "old program: the loader refuses to run a program of 0.1 with libluxfer.so.$abi"
