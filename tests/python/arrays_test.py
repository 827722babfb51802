import unittest

import numpy as np
import pleat
import take


class ArraysTest(unittest.TestCase):
    def test_results_are_arrays_of_their_own(self):
        first, second = take.performer().frame(0), take.performer().frame(0)
        first += 1
        self.assertFalse(np.array_equal(first, second))

    def test_float32_poses_are_widened(self):
        roots, rotations = take.queries([4])
        narrow, _ = take.character().evaluate_poses(roots.astype(np.float32), rotations.astype(np.float32))
        exact, _ = take.character().evaluate_poses(roots, rotations)
        np.testing.assert_allclose(narrow, exact, atol=1e-5)

    def test_shapes_are_named(self):
        with self.assertRaisesRegex(pleat.Error, r"rotations has the shape \(2, 2\), expected \(any, any, 4\)"):
            pleat.Motion(np.zeros((2, 3)), np.zeros((2, 2)))


if __name__ == "__main__":
    unittest.main()
