"""Runs the code of docs/guide/python.md, in its order, in a folder of its own."""

import os
import tempfile
import unittest

from guide import blocks_of


class GuideTest(unittest.TestCase):
    def test_the_code_of_the_page_runs(self):
        blocks = blocks_of("python.md", "python")
        self.assertGreaterEqual(len(blocks), 5)
        names = {"__name__": "guide"}
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for number, block in enumerate(blocks, 1):
                    exec(compile(block, f"docs/guide/python.md, block {number}", "exec"), names)
            finally:
                os.chdir(before)
        self.assertEqual(names["positions"].shape, names["take"].positions.shape)
        self.assertLess(names["error_mm"], 10)


if __name__ == "__main__":
    unittest.main()
