"""Makes the figures of the paper's experiments from one take, cell by cell as a notebook.

usage: figures.py [TAKE [FOLDER]]     without a take, of a generated performer

The figures are PNG files where matplotlib is installed; the numbers are written as JSON in any case.
"""

# %% The take
import json
import pathlib
import sys

import pleat

take = pleat.read(sys.argv[1]) if len(sys.argv) > 1 else pleat.performer(60, 1200)
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "figures")
folder.mkdir(parents=True, exist_ok=True)

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    plt = None

# %% One comparison: each variant is learned and measured on the frames of the protocol
def compare(name, protocol="reconstruct"):
    rows = pleat.experiment(take, name, protocol=protocol)
    (folder / f"{name}.json").write_text(json.dumps(rows, indent=1))
    for group in sorted({row["group"] for row in rows}):
        of_group = [row for row in rows if row["group"] == group]
        for row in of_group:
            mean = row["report"]["errors"]["hybrid"]["mean_percent"]
            print(f"{name:20} {group:24} {row['name']:24} {mean:.3f} %")
        if plt is not None:
            plot(f"{name}-{group}", of_group)


def plot(title, rows):
    figure, axes = plt.subplots(figsize=(7, 3))
    skinned = rows[0]["report"]
    axes.plot(skinned["test_frames"], skinned["errors"]["skinned"]["frame_mean_percent"], label="skinned only")
    for row in rows:
        report = row["report"]
        axes.plot(report["test_frames"], report["errors"]["hybrid"]["frame_mean_percent"], label=row["name"])
    axes.set(title=title, xlabel="frame", ylabel="error, % of the diagonal")
    axes.legend()
    figure.tight_layout()
    figure.savefig(folder / f"{title.replace(' ', '_').replace('/', '_')}.png", dpi=120)
    plt.close(figure)


# %% All of them (Figure 5a, 5b and 5c, and the comparison with skinning alone)
for name in pleat.experiment_names():
    compare(name)
