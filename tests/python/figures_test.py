"""The notebook-like example makes a table of every experiment of the paper."""

import json
import pathlib
import runpy
import sys
import tempfile
import unittest

import numpy as np
import pleat
import take

EXAMPLE = pathlib.Path(__file__).parents[2] / "client/examples/python/figures.py"


class FiguresTest(unittest.TestCase):
    def test_every_experiment_is_made(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            np.savez(folder / "take.npz", positions=take.performer().positions, faces=take.performer().triangles)
            before = sys.argv
            sys.argv = [str(EXAMPLE), str(folder / "take.npz"), str(folder / "out")]
            try:
                runpy.run_path(str(EXAMPLE))
            finally:
                sys.argv = before
            for name in pleat.experiment_names():
                rows = json.loads((folder / "out" / f"{name}.json").read_text())
                self.assertGreaterEqual(len(rows), 1, name)
            pictures = {path.stem for path in (folder / "out").glob("*.png")}
            try:
                import matplotlib  # noqa: F401
            except ImportError:
                print("the pictures are skipped: python3-matplotlib is not on this machine")
                return
            self.assertLessEqual({"character", "edits"}, pictures)
            self.assertGreaterEqual(len(pictures), 2 + len(pleat.experiment_names()))


if __name__ == "__main__":
    unittest.main()
