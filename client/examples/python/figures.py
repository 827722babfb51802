"""Makes the figures of the paper's experiments from one take, cell by cell as a notebook.

usage: figures.py [TAKE [FOLDER]]     without a take, of a generated performer

The figures are PNG files where matplotlib is installed; the numbers are written as JSON in any case. An editor that
knows cells (`# %%`) runs them one by one.
"""

# %% The take
import json
import pathlib
import sys

import numpy as np
import pleat

take = pleat.read(sys.argv[1]) if len(sys.argv) > 1 else pleat.performer(60, 1200)
folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "figures")
folder.mkdir(parents=True, exist_ok=True)

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.collections import PolyCollection
except ImportError:
    plt = None


# %% Pictures: meshes from the front, each triangle shaded by how it faces the light
def draw_mesh(axes, positions, triangles):
    corners = positions[triangles].astype(float)  # F x 3 x 3
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    light = np.abs(normals @ [.4, .5, .77]) / np.where(lengths > 0, lengths, 1)
    order = np.argsort(corners[:, :, 2].mean(axis=1))  # the nearest last
    shades = np.clip(.25 + .7 * light[order], 0, 1)
    axes.add_collection(PolyCollection(corners[order][:, :, :2], facecolors=np.repeat(shades[:, None], 3, axis=1),
                                       edgecolors="face", linewidths=.2))
    axes.set_aspect("equal")
    axes.axis("off")


def draw_rows(name, rows):
    """rows: {title: meshes of as many frames as the others}."""
    if plt is None:
        return
    columns = len(next(iter(rows.values())))
    figure, grid = plt.subplots(len(rows), columns, figsize=(1.6 * columns, 2.4 * len(rows)), squeeze=False,
                                sharex=True, sharey=True)
    for line, (title, meshes) in zip(grid, rows.items(), strict=True):
        for axes, mesh in zip(line, meshes, strict=True):
            draw_mesh(axes, mesh, take.triangles)
        line[0].set_title(title, loc="left", fontsize=9)
    for axes in grid.flat:
        axes.autoscale_view()
    figure.tight_layout()
    figure.savefig(folder / f"{name}.png", dpi=130)
    plt.close(figure)


# %% The character: the input, its skinned rig, and with the learned detail (as Figures 1 and 4)
character = pleat.train(take, learner="gp")
motion = character.fit(take)
frames = np.linspace(0, take.num_frames - 1, 5).astype(int)
skinned, _ = character.evaluate(motion, skinned_only=True)
hybrid, _ = character.evaluate(motion)
draw_rows("character", {"input": take.positions[frames], "skinned only": skinned[frames], "hybrid": hybrid[frames]})

# %% Edits: the arms raised, and new proportions (as Figure 6)
rotations = motion.rotations
raised = np.radians(30)
for side, sign in (("left", 1), ("right", -1)):
    if f"{side}LowerArm" in character.joint_names:
        rotations[:, character.joint_names.index(f"{side}LowerArm")] = [0, 0, sign * np.sin(raised / 2),
                                                                        np.cos(raised / 2)]
edited, edited_confidence = character.evaluate(pleat.Motion(motion.root_positions, rotations, fps=motion.fps))
scales = np.ones(character.num_joints)
for joint, name in enumerate(character.joint_names):
    if "Leg" in name or "Foot" in name:
        scales[joint] = 1.2
longer, _ = character.evaluate(motion, bone_scales=scales)
draw_rows("edits", {"hybrid": hybrid[frames], "arms edited": edited[frames], "legs 20 % longer": longer[frames]})


# %% One comparison: each variant is learned and measured on the frames of the protocol
FIGURES = {"full-vs-fine": "Figure 5a", "representations": "Figure 5b", "resolutions": "Figure 5c",
           "skinned-vs-hybrid": "second experiment"}


def compare(name, protocol="reconstruct"):
    rows = pleat.experiment(take, name, protocol=protocol)
    (folder / f"{name}.json").write_text(json.dumps(rows, indent=1))
    for group in sorted({row["group"] for row in rows}):
        of_group = [row for row in rows if row["group"] == group]
        for row in of_group:
            mean = row["report"]["errors"]["hybrid"]["mean_percent"]
            print(f"{name:20} {group:24} {row['name']:24} {mean:.3f} %")
        if plt is not None:
            plot(f"{name}-{group}", f"{FIGURES.get(name, name)}, {group}", of_group)


def plot(file_name, title, rows):
    figure, axes = plt.subplots(figsize=(7, 3))
    first = rows[0]["report"]
    axes.plot(first["test_frames"], first["errors"]["skinned"]["frame_mean_percent"], label="skinned only")
    for row in rows:
        report = row["report"]
        axes.plot(report["test_frames"], report["errors"]["hybrid"]["frame_mean_percent"], label=row["name"])
    axes.set(title=title, xlabel="frame", ylabel="error, % of the diagonal", yscale="log")
    axes.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(folder / f"{file_name.replace(' ', '_').replace('/', '_')}.png", dpi=120)
    plt.close(figure)


# %% All of them
for name in pleat.experiment_names():
    compare(name)
