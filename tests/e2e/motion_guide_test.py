"""Runs the commands of docs/guide/motion.md, in their order, in a folder of its own.

usage: motion_guide_test.py FOLDER_OF_PROGRAMS
"""

import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PAGE = pathlib.Path(__file__).parents[2] / "docs/guide/motion.md"
PROGRAMS = sys.argv.pop() if len(sys.argv) > 1 else ""

# A T-pose in centimeters with names as Mixamo gives them: (name, parent, offset).
JOINTS = [
    ("Hips", None, (0, 95, 0)),
    ("Spine", "Hips", (0, 10, 0)), ("Spine1", "Spine", (0, 12, 0)), ("Spine2", "Spine1", (0, 12, 0)),
    ("Neck", "Spine2", (0, 14, 0)), ("Head", "Neck", (0, 10, 0)),
    ("LeftShoulder", "Spine2", (4, 10, 0)), ("LeftArm", "LeftShoulder", (13, 0, 0)),
    ("LeftForeArm", "LeftArm", (27, 0, 0)), ("LeftHand", "LeftForeArm", (26, 0, 0)),
    ("RightShoulder", "Spine2", (-4, 10, 0)), ("RightArm", "RightShoulder", (-13, 0, 0)),
    ("RightForeArm", "RightArm", (-27, 0, 0)), ("RightHand", "RightForeArm", (-26, 0, 0)),
    ("LeftUpLeg", "Hips", (9, -4, 0)), ("LeftLeg", "LeftUpLeg", (0, -42, 0)),
    ("LeftFoot", "LeftLeg", (0, -42, 0)), ("LeftToeBase", "LeftFoot", (0, -6, 14)),
    ("RightUpLeg", "Hips", (-9, -4, 0)), ("RightLeg", "RightUpLeg", (0, -42, 0)),
    ("RightFoot", "RightLeg", (0, -42, 0)), ("RightToeBase", "RightFoot", (0, -6, 14)),
]


def hierarchy(name, depth=0):
    pad = "\t" * depth
    _, parent, offset = next(joint for joint in JOINTS if joint[0] == name)
    root = parent is None
    yield f"{pad}{'ROOT' if root else 'JOINT'} {name}\n{pad}{{\n{pad}\tOFFSET {offset[0]} {offset[1]} {offset[2]}\n"
    positions = "Xposition Yposition Zposition " if root else ""
    yield f"{pad}\tCHANNELS {6 if root else 3} {positions}Zrotation Xrotation Yrotation\n"
    children = [joint[0] for joint in JOINTS if joint[1] == name]
    for child in children:
        yield from hierarchy(child, depth + 1)
    if not children:
        yield f"{pad}\tEnd Site\n{pad}\t{{\n{pad}\t\tOFFSET 0 0 5\n{pad}\t}}\n"
    yield f"{pad}}}\n"


def walk(num_frames):
    order = re.findall(r"(?:ROOT|JOINT) (\w+)", "".join(hierarchy("Hips")))
    for frame in range(num_frames):
        phase = 2 * math.pi * frame / 30
        swing, bend = 25 * math.sin(phase), 20 * (1 - math.cos(phase))
        angles = {"LeftUpLeg": (0, -swing, 0), "RightUpLeg": (0, swing, 0), "LeftLeg": (0, bend, 0),
                  "RightLeg": (0, 40 - bend, 0), "LeftArm": (-75, 0, swing / 2), "RightArm": (75, 0, swing / 2)}
        values = [0, 95 + math.cos(2 * phase), 2.5 * frame]
        for name in order:
            values += angles.get(name, (0, 0, 0))
        yield " ".join(f"{value:.5f}" for value in values) + "\n"


class MotionGuideTest(unittest.TestCase):
    def test_the_commands_of_the_page_run(self):
        blocks = re.findall(r"^```sh\n(.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL)
        self.assertGreaterEqual(len(blocks), 8)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "clip.bvh").write_text(
                "HIERARCHY\n" + "".join(hierarchy("Hips")) +
                "MOTION\nFrames: 61\nFrame Time: 0.033333\n" + "".join(walk(61)))
            environment = dict(os.environ, PATH=f"{PROGRAMS}:{os.environ['PATH']}", HOME=str(folder))
            for number, block in enumerate(blocks, 1):
                done = subprocess.run(["sh", "-eu", "-c", block], cwd=folder, env=environment, check=False,
                                      capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, f"block {number}:\n{block}\n{done.stdout}{done.stderr}")
            tall = json.loads((folder / "tall.json").read_text())
            self.assertEqual(tall["detail_strengths"]["leftHand"], 0)
            self.assertEqual(tall["detail_strengths"]["head"], 1.5)
            self.assertEqual(tall["bone_scales"]["leftFoot"], 1.15)
            self.assertEqual(len(tall["edits"]), 3)
            self.assertEqual(json.loads((folder / "round.json").read_text())["fps"], 24)
            self.assertEqual(len(json.loads((folder / "walk.json").read_text())["frames"]), 61)


if __name__ == "__main__":
    unittest.main()
