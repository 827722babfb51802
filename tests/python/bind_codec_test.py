import unittest

import numpy as np
import pleat
import take


class CodecTest(unittest.TestCase):
    def test_a_promised_error_is_kept(self):
        data, measured = pleat.compress(take.performer(), max_error_mm=.5)
        back = pleat.decompress(data)
        error_mm = 1000 * np.linalg.norm(back.positions - take.performer().positions, axis=2).max()
        self.assertLessEqual(error_mm, .5)
        self.assertAlmostEqual(measured["max_error_mm"], error_mm, places=4)
        self.assertLess(len(data), take.performer().positions.nbytes / 5)
        np.testing.assert_array_equal(back.triangles, take.performer().triangles)

    def test_there_is_one_promise(self):
        for promises in ({}, {"max_error_mm": 1, "grid_bits": 12}):
            with self.assertRaisesRegex(pleat.Error, "give one of"):
                pleat.compress(take.performer(), **promises)
        with self.assertRaises(pleat.Error):
            pleat.compress(take.performer(), kg_percent=1000)

    def test_damaged_bytes_are_errors(self):
        data, _ = pleat.compress(take.performer().subset([0, 1, 2]), grid_bits=10)
        for damaged in (b"", b"no .plt", data[:len(data) // 2]):
            with self.assertRaises(pleat.Error):
                pleat.decompress(damaged)


if __name__ == "__main__":
    unittest.main()
