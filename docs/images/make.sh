#!/usr/bin/env bash
# Draws the two pictures at the top of the README: a generated performer, and the same frames after an edit.
set -euo pipefail
cd "$(dirname "$0")/../.."
pleat=${PLEAT_BIN:-build/bin}/pleat
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$pleat" generate performer -o "$work" --frames 160 --vertices 6000 --seed 3
"$pleat" train "$work/performer.pc2" --local -q -o "$work/character.pleat"
"$pleat" motion "$work/character.pleat" "$work/performer.pc2" -q -o "$work/edited.json" \
  --offset-rotation leftLowerArm=0,0,70 --offset-rotation rightLowerArm=0,0,-70 --offset-rotation head=0,35,0
"$pleat" pose "$work/character.pleat" --local -q --motion "$work/edited.json" -o "$work/edited.pc2"
for name in input edited; do
  take=$work/edited.pc2
  [ $name = edited ] || take=$work/performer.pc2
  "$pleat" render "$take" -q --force -o docs/images/$name.png --label $name --frames 20,45,70,95 \
    --tile-width 260 --tile-height 330
done
