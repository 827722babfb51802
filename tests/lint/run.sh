#!/usr/bin/env bash
# The static gate: formatting, structure, citations, and the tests of the gate itself.
set -euo pipefail
cd "$(dirname "$0")/../.."

echo "lint: clang-format"
git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror

echo "lint: structure"
python3 tests/lint/structure.py
echo "lint: citations"
python3 tests/lint/citations.py
echo "lint: tests of the lint"
python3 -m unittest discover --start-directory tests/lint --pattern '*_test.py'
echo "lint: clean"
