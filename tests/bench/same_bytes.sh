#!/usr/bin/env bash
# Proves that two builds write the same bytes: models of every learner, compressed sequences, meshes of an edited
# motion, and the frames and parameters that a server streams.
#   tests/bench/same_bytes.sh sums BIN [INPUT...]             prints "SHA-256  what" of everything that BIN writes
#   tests/bench/same_bytes.sh compare BEFORE AFTER [INPUT...] runs both folders of programs and compares
# The generated performer is always among the inputs. The sums depend on the machine only where its processor has no
# FMA, so compare on one machine.
set -euo pipefail

write_all() {  # BIN OUT INPUT NAME
  local bin=$1 out=$2 input=$3 name=$4
  mkdir -p "$out"
  "$bin/pleat" train "$input" --local -q -o "$out/$name.pleat"
  "$bin/pleat" train "$input" --local -q --preset paper -o "$out/$name.paper.pleat"
  "$bin/pleat" motion "$out/$name.pleat" "$input" -q -o "$out/$name.json" --offset-rotation head=0,35,0
  "$bin/pleat" pose "$out/$name.pleat" --local -q --motion "$out/$name.json" -o "$out/$name.pc2"
  "$bin/pleat" pose "$out/$name.pleat" --local -q --motion "$out/$name.json" -o "$out/$name.drc" --format drc
  "$bin/pleat" compress "$input" -q --max-error-mm 1 -o "$out/$name.plt"
  "$bin/pleat" compress "$input" -q --lossless-at-bits 12 -o "$out/$name.exact.plt"
  "$bin/pleat" decompress "$out/$name.plt" -q -o "$out/$name.decoded.pseq"
}

stream_all() {  # BIN OUT INPUT NAME SERVER: what comes over the wire
  local bin=$1 out=$2 input=$3 name=$4 server=$5 model encoding content
  "$bin/pleat" train "$input" --server "$server" -q -o "$out/$name.served.pleat" --report "$out/$name.report.json"
  model=$(sed -n 's/.*"model_id": "\([0-9a-f]*\)".*/\1/p' "$out/$name.report.json")
  rm "$out/$name.report.json"  # has times in it
  for encoding in mesh points; do
    "$bin/pleat" pose "$model" --server "$server" -q --motion "$out/$name.json" --encoding $encoding \
      -o "$out/$name.$encoding/"
  done
  "$bin/pleat" pose "$model" --server "$server" -q --motion "$out/$name.json" --content control --format drc \
    -o "$out/$name.control/"
  "$bin/pleat" pose "$model" --server "$server" -q --motion "$out/$name.json" --content parameters \
    -o "$out/$name.parameters.pc2"
}

sums() {  # BIN OUT INPUT...
  local bin=$1 out=$2 input pid
  shift 2
  rm -rf "$out" && mkdir -p "$out/files"
  "$bin/pleat" generate performer -q -o "$out/files/made" --frames 90 --vertices 3000 >&2
  "$bin/pleatd" --listen 127.0.0.1:0 --data-dir "$out/store" >"$out/pleatd.out" 2>"$out/pleatd.log" &
  pid=$!
  trap 'kill -TERM $pid 2>/dev/null || true' RETURN
  until grep -q '^listening on ' "$out/pleatd.out"; do kill -0 $pid; sleep 0.05; done
  for input in "$out/files/made/performer.pc2" "$@"; do
    write_all "$bin" "$out/files" "$input" "$(basename "${input%.*}")" >&2
    stream_all "$bin" "$out/files" "$input" "$(basename "${input%.*}")" "$(sed -n 's/^listening on //p' "$out/pleatd.out")" >&2
  done
  for learner in regional gp sgplvm back-constrained ridge; do
    "$bin/pleat" train "$out/files/made/performer.pc2" --local -q --learner $learner -o "$out/files/$learner.pleat" >&2
  done
  for name in $(cd "$out/files" && LC_ALL=C ls); do  # a folder counts as its files in order
    printf '%s  %s\n' "$(cd "$out/files" && find "$name" -type f -print0 | LC_ALL=C sort -z | xargs -0 cat | sha256sum |
      cut -d ' ' -f 1)" "$name"
  done
}

verb=${1:?sums or compare}
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
case $verb in
  sums) bin=$1; shift; sums "$bin" "$work/out" "$@" ;;
  compare)
    before=$1 after=$2
    shift 2
    sums "$before" "$work/before" "$@" >"$work/before.txt"
    sums "$after" "$work/after" "$@" >"$work/after.txt"
    diff "$work/before.txt" "$work/after.txt" && echo "the same bytes in $(wc -l <"$work/after.txt") files"
    ;;
  *) echo "same_bytes.sh: unknown verb $verb" >&2; exit 2 ;;
esac
