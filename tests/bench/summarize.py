"""One line per report of `pleat train`, `evaluate` (mean errors in % of the diagonal) or `compress`."""

import json
import sys

report = json.load(open(sys.argv[1], encoding="utf-8"))
label = sys.argv[2] if len(sys.argv) > 2 else ""
if report["schema"].startswith("pleat.train"):
    print(f"fit rms {report['fit']['rms_percent']:.3f} %  reconstruction mean "
          f"{report['reconstruction']['mean_percent']:.4f} %  learner {report['learner']}  "
          f"total {report['seconds']['total']:.1f} s  peak {report['peak_memory_bytes'] / 1e6:.0f} MB  "
          f"model {report['model_bytes'] / 1e6:.1f} MB")
    poses = report["poses"]
    if report["options"]["smoothness"] > 0:
        print(f"  smoothness {report['options']['smoothness']}: jitter {poses['unsmoothed_jitter_degrees']:.3f} -> "
              f"{poses['jitter_degrees']:.3f} degrees, fit rms {poses['unsmoothed_rms_percent']:.3f} -> "
              f"{report['fit']['rms_percent']:.3f} %")
elif report["schema"].startswith("pleat.compress"):
    print(f"{report['bytes']} bytes, {report['bpvf']:.3f} bits per vertex and frame, KG {report['kg_percent']:.2f} %, "
          f"encoded in {report['encode_seconds']:.2f} s, decoded in {report['decode_seconds']:.3f} s")
else:
    errors = {"skinned": report["skinned"], **report["baselines"], **report["learners"]}
    errors.pop("zero", None)
    print(f"{label:45s}" + "  ".join(f"{name} {e['mean_percent']:.3f}" for name, e in errors.items())
          + f"  (hybrid = {report['learner']}, p95 {report['hybrid']['p95_percent']:.3f}, "
          f"{report['hybrid']['mean_mm']:.2f} mm)")
