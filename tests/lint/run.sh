#!/usr/bin/env bash
# The static gate: formatting and structure rules.
set -euo pipefail
cd "$(dirname "$0")/../.."

echo "lint: clang-format"
git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror

echo "lint: structure"
python3 tests/lint/structure.py
echo "lint: clean"
