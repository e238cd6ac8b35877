#!/bin/sh
# Another compiler's opinion of what users compile: the header with every warning that clang has, as C and as C++; the wrapper with
# every one that says something about it, in both of its modes; examples, harnesses and the guide's programs as strict users compile them.
#
#   clang.sh SOURCE      exits with 77 where there is no clang
set -eu
cd "$1"
command -v clang >/dev/null && command -v clang++ >/dev/null || exit 77
strict="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror"
# C++98 is not meant; classes may have gaps, and virtual functions inline ones.
every="-Weverything -Werror -Wno-c++98-compat -Wno-c++98-compat-pedantic -Wno-padded -Wno-weak-vtables"

# The includes before the code: what is looked at is the header, not the system's.
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
for program in tests/docs/*.cpp tests/package/*.cpp tests/cpp/wrapper*.cpp tests/cpp/abi_contract.cpp tests/cpp/host.cpp tests/cpp/unload.cpp; do
  clang++ -std=c++17 $strict -fsyntax-only -Iinclude -Ibindings/cpp "$program"
done
echo "clang: no warning"
