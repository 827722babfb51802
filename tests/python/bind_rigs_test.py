import unittest

import numpy as np
import pleat
import take


class RigTest(unittest.TestCase):
    def test_a_performer_is_rigged(self):
        rig = pleat.rig(take.performer())
        self.assertEqual(len(rig.joint_names), 18)
        self.assertEqual(rig.parents[0], -1)
        self.assertEqual(rig.joint_positions.shape, (18, 3))
        np.testing.assert_allclose(rig.weights.sum(axis=1), 1, atol=1e-4)
        np.testing.assert_allclose(rig.rest_positions, take.performer().frame(rig.rest_frame), atol=1e-6)
        self.assertLess(rig.residual, .1)
        self.assertIsInstance(rig.warnings, list)

    def test_a_box_is_no_person(self):
        box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], np.float32)
        faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        with self.assertRaises(pleat.Error):
            pleat.rig(pleat.Sequence(box[None], faces))
        with self.assertRaisesRegex(pleat.Error, "frame"):
            pleat.rig(take.performer(), rest_frame=4000)


if __name__ == "__main__":
    unittest.main()
