#!/bin/sh
# Checks everything that users compile with clang: the header with all of clang's warnings, as C and as C++; the
# wrapper with all warnings that apply to it, with and without exceptions; the examples, the harnesses and the guide's
# programs with strict warnings, and so the OpenFX plug-in if OPENFX_ROOT or target/peers/openfx has the OpenFX sources.
#
#   clang.sh SOURCE      exits with 77 if clang is not installed
set -eu
cd "$1"
command -v clang >/dev/null && command -v clang++ >/dev/null || exit 77
strict="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror"
# Except warnings about compatibility with C++98, padding in classes, and classes whose virtual functions are all
# inline.
every="-Weverything -Werror -Wno-c++98-compat -Wno-c++98-compat-pedantic -Wno-padded -Wno-weak-vtables"

# Include the header from standard input: clang then warns about this header, but not about the system's headers.
for standard in c99 c11 c17; do
  echo '#include "include/luxfer.h"' | clang -std=$standard -Weverything -Werror -fsyntax-only -x c - -I.
done
for standard in c++17 c++20; do
  for header in include/luxfer.h bindings/cpp/luxfer.hpp; do
    echo "#include \"$header\"" | clang++ -std=$standard $every -fsyntax-only -x c++ - -I. -Iinclude
  done
  echo '#include "bindings/cpp/luxfer.hpp"' |
    clang++ -std=$standard $every -DLUXFER_NO_EXCEPTIONS -fno-exceptions -fsyntax-only -x c++ - -I. -Iinclude
done
for program in examples_c/*.c tests/package/*.c; do
  clang -std=c99 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -Iinclude "$program"
done
for program in tests/docs/*.cpp tests/package/*.cpp tests/cpp/wrapper*.cpp tests/cpp/abi_contract.cpp tests/cpp/host.cpp tests/cpp/unload.cpp tests/cpp/start_up.cpp; do
  clang++ -std=c++17 $strict -fsyntax-only -Iinclude -Ibindings/cpp "$program"
done
openfx="${OPENFX_ROOT:-target/peers/openfx}"
if [ -d "$openfx/include" ]; then
  for program in bindings/openfx/*.cpp; do
    clang++ -std=c++17 $strict -fsyntax-only -Iinclude -Ibindings/cpp -isystem "$openfx/include" "$program"
  done
fi
echo "clang: no warning"
