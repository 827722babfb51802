#!/usr/bin/env bash
# Every number of docs/performance.md: ./dev bench [FOLDER OF CAPTURED SEQUENCES]
# The benchmarks run on generated data. The evaluations run on samba, crane and skirt where they are
# (argument, PLEAT_SHARED_DATA, or ../shared/data), else on a generated performer.
set -euo pipefail
cd "$(dirname "$0")/../.."
data=${1:-${PLEAT_SHARED_DATA:-../shared/data}}
pleat=build/bin/pleat
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

for bench in gp fitting character engine codec server; do
  echo "== ${bench}_bench"
  "build/bin/${bench}_bench" --benchmark_min_time=0.2 2>/dev/null
done
if [ -f build/python/pleat/py.typed ]; then  # with Debian's Python, for which it was built
  PYTHONPATH=build/python:tests/c /usr/bin/python3 tests/bench/python_calls.py build/client/c/libpleat_eval.so
fi
echo "== live_beside_jobs"
build/bin/live_beside_jobs
echo "== store_bench"
build/bin/store_bench --benchmark_min_time=0.2 2>/dev/null

# The automatic rig of everything that is there, from its first frame and from frame 50 on; inputs
# that are no humans are refused, which the exit code says and the table shows.
echo "== rig"
"$pleat" generate performer -o "$out/generated" --frames 120 --vertices 10000 --quiet
meshes=()
rigs=("$out/generated/performer.pc2") truths=("$out/generated/truth.json")
for name in samba crane rumba skirt/walk_a skirt/walk_b chicken_crossing horse_gallop; do
  [ -f "$data/$name.pc2" ] || continue
  truth=-
  if [ -f "$data/${name}_truth.npz" ]; then
    truth=$out/$(basename "$name").json
    python3 tests/bench/rig_truth.py "$data/skirt/template_truth.npz" "$data/${name}_truth.npz" 0 >"$truth"
  fi
  rigs+=("$data/$name.pc2") truths+=("$truth")
done
"$pleat" rig "${rigs[@]}" --truth "${truths[@]}" --threads 1 2>/dev/null || true
"$pleat" rig "${rigs[@]:0:6}" --truth "${truths[@]:0:6}" --threads 1 --first-frame 50 2>/dev/null || true
for mesh in "$data"/static/*.obj; do
  [ -f "$mesh" ] && meshes+=("$mesh")
done
[ ${#meshes[@]} -eq 0 ] || "$pleat" rig "${meshes[@]}" --threads 1 2>/dev/null || true
build/bin/rig_bodies performer "${meshes[@]}"
build/bin/rig_bodies --orientations performer
build/bin/rig_figures
for words in "girth 1 legs 1 arms 50" "animals: horse" "animals: bear" "robe 0.17 arms 50"; do
  build/bin/rig_figures --all --split 3 "$words"
done

inputs=()
for name in samba crane; do
  [ -f "$data/$name.pc2" ] && inputs+=("$data/$name.pc2")
done
if [ ${#inputs[@]} -eq 0 ]; then
  echo "captured sequences are not on this machine: evaluating a generated performer"
  "$pleat" generate performer -o "$out/performer" --frames 175 --vertices 10000 --quiet
  inputs=("$out/performer/performer.pc2")
fi

echo "== compress_curves (PNGs in build/bench)"
curves=("${inputs[@]}")
for name in chicken_crossing horse_gallop; do
  [ -f "$data/$name.pc2" ] && curves+=("$data/$name.pc2")
done
mkdir -p build/bench
build/bin/compress_curves build/bench "${curves[@]}"

echo "== obj_folder"
build/bin/obj_folder "$out/obj"

echo "== file_formats"
mkdir -p "$out/formats"
build/bin/file_formats "$out/formats"

echo "== refinement"
build/bin/refine_table "${inputs[@]}"

# A server of its own, and load on it. Believe this on an idle machine only.
echo "== pleat bench (plots in build/bench)"
build/bin/pleatd --listen 127.0.0.1:0 --data-dir "$out/store" --log-level warning >"$out/pleatd.log" 2>&1 &
pleatd=$!
trap 'kill $pleatd 2>/dev/null; rm -rf "$out"' EXIT
until grep -q "listening on" "$out/pleatd.log"; do sleep .1; done
address=$(sed -n 's/^listening on //p' "$out/pleatd.log")
"$pleat" train "${inputs[0]}" --server "$address" -o "$out/live.pleat" --quiet --report "$out/live.json" >/dev/null
model=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["model_id"])' "$out/live.json")
"$pleat" motion "$out/live.pleat" "${inputs[0]}" -o "$out/live_motion.json" --quiet >/dev/null
load() {  # NAME FLAG...
  local name=$1
  shift
  echo "-- $name: $*"
  "$pleat" bench "$model" --server "$address" --motion "$out/live_motion.json" --force --plot "build/bench/$name.png" "$@"
}
load one_client --clients 1 --rate 30 --seconds 10
load one_client_points --clients 1 --rate 30 --seconds 10 --encoding points
load thirty_clients --clients 30 --rate 30 --seconds 10
load thirty_clients_poisson --clients 30 --rate 30 --seconds 10 --arrivals poisson
load throughput --clients 4 --seconds 5 --closed-loop
echo "== compression by that server, from upload to download"
for where in "--server $address" ""; do
  TIMEFORMAT="%R s ${where:-here}"
  # shellcheck disable=SC2086  # a flag and its value
  time "$pleat" compress "${inputs[0]}" $where --kg 1 --force -o "$out/x.plt" --quiet --report "$out/c.json" >/dev/null
  python3 tests/bench/summarize.py "$out/c.json"
done
kill $pleatd

for input in "${inputs[@]}"; do
  echo "== train $input"
  "$pleat" train "$input" --local --force -o "$out/model.pleat" --quiet --report "$out/train.json" >/dev/null
  python3 tests/bench/summarize.py "$out/train.json"
  for smoothness in .001 .01 .1; do
    "$pleat" train "$input" --local --force -o "$out/model.pleat" --quiet --smooth $smoothness \
      --report "$out/train.json" >/dev/null
    python3 tests/bench/summarize.py "$out/train.json"
  done
  for refine in none joints; do
    for protocol in every5th blocks10 last30; do
      "$pleat" evaluate "$input" --protocol $protocol --refine $refine --learner gp --measure gp \
        --quiet --force --report "$out/e.json" >/dev/null
      python3 tests/bench/summarize.py "$out/e.json" "$protocol --refine $refine"
    done
  done
  for protocol in reconstruct every5th blocks10 last30; do
    for variant in "--resolution 100" "--resolution 5" "--resolution 5 --upsampling rbf" "--preset paper"; do
      # shellcheck disable=SC2086  # a variant is several words
      "$pleat" evaluate "$input" --protocol $protocol $variant --quiet --force --report "$out/e.json" >/dev/null
      python3 tests/bench/summarize.py "$out/e.json" "$protocol $variant"
    done
  done
done

echo "== scale_curve (PNG in build/bench)"
build/bin/scale_curve build/bench

# The paper's figures: tables here, tables and plots in build/bench/experiments.
figures=build/bench/experiments
experiments() {  # experiments NAME INPUT [flags...]: all four, on training frames and on unseen ones
  local name=$1 input=$2
  shift 2
  for experiment in full-vs-fine representations resolutions skinned-vs-hybrid; do
    for preset in paper default; do
      echo "== $name $experiment --preset $preset $*"
      "$pleat" evaluate "$input" --experiment $experiment --preset $preset "$@" --quiet \
        --force --out "$figures/$name-$preset"
    done
  done
}
for input in "${inputs[@]}"; do
  for protocol in reconstruct blocks10; do
    experiments "$(basename "$input" .pc2)-$protocol" "$input" --protocol $protocol
  done
done
# Every learner, the default one against them.
for input in "${inputs[@]}"; do
  for protocol in every5th blocks10 last30; do
    "$pleat" evaluate "$input" --protocol $protocol --learner regional --quiet \
      --measure gp sgplvm back-constrained ridge
  done
done
if [ -f "$data/skirt/walk_a.pc2" ]; then
  experiments skirt "$data/skirt/walk_a.pc2" --protocol cross --test "$data/skirt/walk_b.pc2"
fi

if [ -f "$data/skirt/walk_a.pc2" ]; then
  for refine in none joints full; do
    "$pleat" evaluate "$data/skirt/walk_a.pc2" --protocol cross --test "$data/skirt/walk_b.pc2" \
      --refine $refine --quiet --force --report "$out/e.json" >/dev/null
    python3 tests/bench/summarize.py "$out/e.json" "skirt walk_a -> walk_b --refine $refine"
  done
fi
