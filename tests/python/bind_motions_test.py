import unittest

import numpy as np
import pleat


class MotionTest(unittest.TestCase):
    def test_arrays_go_in_and_come_out(self):
        roots = np.arange(6.).reshape(2, 3)
        rotations = np.tile([0., .6, 0, .8], (2, 5, 1))
        motion = pleat.Motion(roots, rotations, fps=24)
        self.assertEqual((len(motion), motion.num_joints, motion.fps), (2, 5, 24))
        np.testing.assert_array_equal(motion.root_positions, roots)
        np.testing.assert_array_equal(motion.rotations, rotations)

    def test_bad_poses_are_errors_with_words(self):
        rotations = np.tile([0., 0, 0, 1], (2, 5, 1))
        for roots, turns, fps, words in (
                (np.zeros((3, 3)), rotations, 30, "root_positions has the shape"),
                (np.zeros((2, 3)), rotations[0], 30, "rotations has the shape"),
                (np.zeros((2, 3)), rotations * 3, 30, "joint 0"),
                (np.full((2, 3), np.nan), rotations, 30, "finite"),
                (np.zeros((2, 3)), rotations, 0, "fps is 0"),
                (np.zeros((0, 3)), rotations[:0], 30, "pose")):
            with self.assertRaisesRegex(pleat.Error, words):
                pleat.Motion(roots, turns, fps=fps)


if __name__ == "__main__":
    unittest.main()
