#!/usr/bin/env bash
# Runs the fuzzers that `./dev fuzz` has built, one after the other, and prints a row for each.
#   tests/fuzz/run.sh SECONDS [NAME...]     NAME: obj, ply, ...; all of them where none is named
# What they find goes to build/fuzz/findings/NAME, and inputs that are new to build/fuzz/corpus/NAME.
# The exit code is 1 when one of them found something.
set -uo pipefail
cd "$(dirname "$0")/../.."

seconds=${1:?usage: tests/fuzz/run.sh SECONDS [NAME...]}
shift
[ $# -gt 0 ] || set -- $(ls build/fuzz/bin | sed -n 's/^fuzz_//p')

failed=0
printf '%-14s %10s %8s  %s\n' fuzzer runs coverage result
for name in "$@"; do
  seeds=()
  [ -d tests/fuzz/seeds/"$name" ] && seeds+=(tests/fuzz/seeds/"$name")
  case $name in engine|model|sequence|compressed) seeds+=(tests/golden) ;; esac
  findings=build/fuzz/findings/$name corpus=build/fuzz/corpus/$name log=build/fuzz/$name.log
  mkdir -p "$findings" "$corpus"
  result=clean
  build/fuzz/bin/fuzz_"$name" -max_total_time="$seconds" -rss_limit_mb=2048 -timeout=60 \
    -artifact_prefix="$findings/" "$corpus" "${seeds[@]}" >"$log" 2>&1 || { result="see $findings and $log"; failed=1; }
  runs=$(sed -n 's/^Done \([0-9]*\) runs.*/\1/p' "$log" | tail -1)
  coverage=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  printf '%-14s %10s %8s  %s\n' "$name" "${runs:--}" "${coverage:--}" "$result"
done
exit $failed
