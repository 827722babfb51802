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


if __name__ == "__main__":
    unittest.main()
