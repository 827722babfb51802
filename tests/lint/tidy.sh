#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy. Arguments: files (default: the library's sources).
set -euo pipefail
cd "$(dirname "$0")/../.."
[ -f build/compile_commands.json ] || cmake --preset dev >/dev/null
files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(git ls-files 'lib/*/src/*.cpp' ':!lib/wire')
printf '%s\n' "${files[@]}" | xargs -P 2 -n 6 clang-tidy -p build --quiet
