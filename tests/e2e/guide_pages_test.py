"""Runs the commands of pages of the guide, each page in a folder of its own, and looks at what they leave.

usage: guide_pages_test.py FOLDER_OF_PROGRAMS
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

GUIDE = pathlib.Path(__file__).parents[2] / "docs/guide"
PROGRAMS = os.path.abspath(sys.argv.pop()) if len(sys.argv) > 1 else ""

# What each page promises to make.
PAGES = {
    "five_minutes.md": ["rig.png", "sheet.png", "edited.png", "edited.abc", "dancer.glb"],
    "packages/maya.md": ["take.pleat", "take.usda", "edited.abc"],
    "packages/houdini.md": ["slow.abc", "slow.mdd"],
    "packages/marvelous_designer.md": ["garment.pleat", "mirrored.pc2"],
    "packages/blender_files.md": ["take.glb", "edited.pc2", "edited.abc"],
    "packages/unreal.md": ["SK_Take.glb", "GC_Take.abc"],
    "packages/unity.md": ["take.glb", "take.abc"],
    "packages/godot.md": ["take.glb", "frames.glb"],
}


class GuidePagesTest(unittest.TestCase):
    def test_every_page_is_run(self):
        packages = {f"packages/{path.name}" for path in (GUIDE / "packages").glob("*.md")}
        self.assertLessEqual(packages, set(PAGES))

    def run_page(self, page, made):
        blocks = re.findall(r"^```sh\n(.*?)^```$", (GUIDE / page).read_text(), re.MULTILINE | re.DOTALL)
        self.assertGreaterEqual(len(blocks), 3, page)
        with tempfile.TemporaryDirectory() as folder:
            environment = dict(os.environ, PATH=f"{PROGRAMS}:{os.environ['PATH']}", HOME=folder)
            for number, block in enumerate(blocks, 1):
                done = subprocess.run(["sh", "-eu", "-c", block], cwd=folder, env=environment, check=False,
                                      capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, f"{page}, block {number}:\n{block}\n{done.stdout}{done.stderr}")
            for name in made:
                self.assertGreater((pathlib.Path(folder) / name).stat().st_size, 0, f"{page}: {name}")

    def test_the_commands_of_the_pages_run(self):
        for page, made in PAGES.items():
            with self.subTest(page):
                self.run_page(page, made)


if __name__ == "__main__":
    unittest.main()
