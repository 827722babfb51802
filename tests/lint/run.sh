#!/usr/bin/env bash
# The static gate: formatting, structure rules, clang-tidy. Arguments: files to tidy (default: lib).
set -euo pipefail
cd "$(dirname "$0")/../.."

echo "lint: clang-format"
git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror

echo "lint: structure"
python3 tests/lint/structure.py

echo "lint: clang-tidy"
[ -f build/compile_commands.json ] || cmake --preset dev >/dev/null
files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(git ls-files 'lib/*/src/*.cpp' ':!lib/wire')
printf '%s\n' "${files[@]}" | xargs -P 2 -n 6 clang-tidy -p build --quiet 2>/dev/null
echo "lint: clean"
