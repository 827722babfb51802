"""Joint truth of the synthetic 'skirt' clips as JSON for `pleat rig --truth`.

usage: rig_truth.py TEMPLATE_TRUTH.npz CLIP_TRUTH.npz FRAME > truth.json

The truth skeleton has 31 motion-capture joints. Fifteen of them mean the same as a joint of the human
template; spine, chest and head do not (the capture has more of them, in other places) and are left out.
Reads the arrays with the standard library alone.
"""

import ast
import json
import struct
import sys
import zipfile

TEMPLATE_NAMES = {"Hips": "hips"}
for side in ("Left", "Right"):
    for theirs, ours in (("UpLeg", "UpperLeg"), ("Leg", "LowerLeg"), ("Foot", "Foot"), ("ToeBase", "Toes"),
                         ("Arm", "UpperArm"), ("ForeArm", "LowerArm"), ("Hand", "Hand")):
        TEMPLATE_NAMES[side + theirs] = side.lower() + ours


def array(archive, name):
    """Shape and flat values of one array of an npz archive."""
    data = archive.read(name + ".npy")
    start = 10 if data[6] == 1 else 12
    length = int.from_bytes(data[8:start], "little")
    header = ast.literal_eval(data[start:start + length].decode("latin1"))
    body, kind = data[start + length:], header["descr"]
    if kind.startswith("<U"):
        width = 4 * int(kind[2:])
        return header["shape"], [body[i:i + width].decode("utf-32-le").rstrip("\0") for i in range(0, len(body), width)]
    code, size = {"<f4": ("f", 4), "<f8": ("d", 8)}[kind]
    return header["shape"], struct.unpack(f"<{len(body) // size}{code}", body)


def main():
    frame = int(sys.argv[3])
    with zipfile.ZipFile(sys.argv[1]) as template:
        _, names = array(template, "joint_names")
    with zipfile.ZipFile(sys.argv[2]) as clip:
        shape, positions = array(clip, "P")
    if not 0 <= frame < shape[0]:
        sys.exit(f"frame {frame} of {shape[0]}")
    joints = []
    for j, name in enumerate(names):
        if name in TEMPLATE_NAMES:
            at = 3 * (frame * shape[1] + j)
            joints.append({"name": TEMPLATE_NAMES[name], "position_m": list(positions[at:at + 3])})
    json.dump({"frame": frame, "joints": joints}, sys.stdout)


if __name__ == "__main__":
    main()
