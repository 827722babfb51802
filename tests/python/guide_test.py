"""Runs the code of docs/guide/python.md, in its order, in a folder of its own; the part on servers on a real one."""

import os
import tempfile
import unittest

from guide import blocks_of
from server_process import ServerProcess


class GuideTest(unittest.TestCase):
    def test_the_code_of_the_page_runs(self):
        blocks = blocks_of("python.md", "python")
        self.assertGreaterEqual(len(blocks), 8)
        try:
            import google.protobuf  # noqa: F401
            import grpc  # noqa: F401
        except ImportError:
            print("the part on servers is skipped: python3-grpcio or python3-protobuf is not on this machine")
            blocks = [block for block in blocks if "_there" not in block]
        names = {"__name__": "guide"}
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder, ServerProcess(os.environ["PLEATD"], f"{folder}/store") as server:
            os.environ["PLEAT_SERVER"] = server.address
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
