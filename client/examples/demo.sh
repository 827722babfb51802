#!/usr/bin/env bash
# The main job, end to end, on real programs: a sequence goes to a server, becomes a character, and comes back in poses
# that it never showed.
#   client/examples/demo.sh [INPUT | --generated]
# Without INPUT: the captured samba where it is (PLEAT_SHARED_DATA, else ../shared/data), else a generated performer.
# Results stay in demo/. PLEAT_BIN: folder of pleat and pleatd (default build/bin).
set -euo pipefail
cd "$(dirname "$0")/../.."

bin=${PLEAT_BIN:-build/bin}
out=demo
data=${PLEAT_SHARED_DATA:-../shared/data}
pleat() { "$bin/pleat" "$@"; }
say() { printf '\n== %s\n' "$*"; }

rm -rf "$out" && mkdir -p "$out"
input=${1:-}
if [ -z "$input" ] && [ -f "$data/samba.pc2" ]; then input=$data/samba.pc2; fi
if [ -z "$input" ] || [ "$input" = --generated ]; then
  say "no captured sequence: generating a performer"
  pleat generate performer -o "$out/made" --frames 160 --vertices 6000
  input=$out/made/performer.pc2
fi
say "input"
pleat inspect "$input"

say "server"
: >"$out/pleatd.out"
"$bin/pleatd" --listen 127.0.0.1:0 --data-dir "$out/store" >"$out/pleatd.out" 2>"$out/pleatd.log" &
server=$!
trap 'kill -TERM $server 2>/dev/null || true' EXIT
for _ in $(seq 200); do
  grep -q '^listening on ' "$out/pleatd.out" && break
  kill -0 $server 2>/dev/null || { cat "$out/pleatd.log"; exit 1; }
  sleep 0.1
done
PLEAT_SERVER=$(sed -n 's/^listening on //p' "$out/pleatd.out")
export PLEAT_SERVER
echo "pleatd on $PLEAT_SERVER"

say "train on the server"
pleat train "$input" -o "$out/character.pleat" --report "$out/train.json"
model=$(sed -n 's/.*"model_id": "\([0-9a-f]*\)".*/\1/p' "$out/train.json")

say "a motion that is not in the input: its own, with livelier arms and a turned head"
pleat motion "$out/character.pleat" "$input" -o "$out/edited.json" \
  --scale-rotation leftLowerArm=1.5 --scale-rotation rightLowerArm=1.5 \
  --offset-rotation head=0,35,0

say "edited frames, streamed by the server as Draco, and as .pc2"
pleat pose "$model" --motion "$out/edited.json" -o "$out/edited_drc"
pleat pose "$out/character.pleat" --motion "$out/edited.json" -o "$out/edited.pc2"

say "contact sheet"
pleat render "$input" "$out/edited_drc" --label input --label edited --model "$out/character.pleat" \
  --count 8 -o "$out/sheet.png"

say "errors on frames that training did not see"
pleat evaluate "$input" --protocol blocks10 --report "$out/evaluate.json"

say "shut down"
kill -TERM $server
wait $server
trap - EXIT
echo "pleatd ended cleanly. Results in $out/: character.pleat, edited.pc2, edited_drc/, sheet.png, train.json, evaluate.json"
