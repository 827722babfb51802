"""Which poses are the history of a frame."""

import math
import unittest

import addon  # noqa: F401: makes the package importable
import numpy as np

from pleat_blender import axes
from pleat_blender.timeline import Timeline


def pose(degrees):
    half = math.radians(degrees) / 2
    return np.array([degrees, 0, 0.]), np.array([[0, 0, 0, 1.], [math.sin(half), 0, 0, math.cos(half)]])


def angle(rotations):
    return 2 * math.degrees(math.atan2(rotations[1, 0], rotations[1, 3]))


class TimelineTest(unittest.TestCase):
    def filled(self, history, fps, frames):
        timeline = Timeline(history, fps)
        for frame in frames:
            timeline.put(frame, *pose(10 * frame))
        return timeline

    def test_at_the_rate_of_the_training_the_history_are_the_frames_before(self):
        roots, rotations = self.filled(3, 25, range(6)).query(5, 25)
        self.assertEqual(roots[:, 0].tolist(), [50, 40, 30])
        self.assertEqual(rotations.shape, (3, 2, 4))

    def test_at_another_rate_poses_are_interpolated(self):
        roots, rotations = self.filled(2, 20, range(6)).query(5, 30)  # one and a half frames earlier
        self.assertAlmostEqual(roots[1, 0], 35)
        self.assertAlmostEqual(angle(rotations[1]), 35, places=6)
        roots, rotations = self.filled(2, 60, range(6)).query(5, 30)  # half a frame earlier
        self.assertAlmostEqual(angle(rotations[1]), 45, places=6)

    def test_what_is_not_known_is_left_out(self):
        timeline = self.filled(3, 25, [0, 1, 2, 9])
        self.assertEqual(len(timeline.query(9, 25)[0]), 1)  # a jump
        self.assertEqual(timeline.query(1, 25)[0][:, 0].tolist(), [10, 0])  # the beginning
        timeline.clear()
        timeline.put(4, *pose(7))
        self.assertEqual(timeline.query(4, 25)[0][:, 0].tolist(), [7])

    def test_an_edit_replaces_the_pose_of_its_frame_alone(self):
        timeline = self.filled(2, 25, range(4))
        timeline.put(3, *pose(90))
        self.assertEqual(timeline.query(3, 25)[0][:, 0].tolist(), [90, 20])

    def test_quaternions_of_opposite_sign_are_one_rotation(self):
        timeline = Timeline(2, 12.5)
        timeline.put(0, *pose(10))
        timeline.put(2, pose(30)[0], -pose(30)[1])
        timeline.put(1, *pose(20))
        roots, rotations = timeline.query(2, 18.75)  # one and a half frames earlier
        self.assertAlmostEqual(abs(angle(rotations[1])), 15, places=6)

    def test_the_lead_of_a_bake_is_the_history(self):
        self.assertEqual(Timeline(2, 25).lead(25), 1)
        self.assertEqual(Timeline(2, 25).lead(30), 2)
        self.assertEqual(Timeline(1, 25).lead(25), 0)

    def test_axes_turn_there_and_back(self):
        points = np.random.default_rng(1).normal(size=(5, 3)).astype(np.float32)
        np.testing.assert_array_equal(axes.from_blender(axes.to_blender(points)), points)
        self.assertEqual(axes.to_blender(np.array([0, 1., 0])).tolist(), [0, 0, 1])  # up is up
        self.assertEqual(axes.rotation_from_blender(*axes.rotation_to_blender(.1, .2, .3, .9)), (.1, .2, .3, .9))


if __name__ == "__main__":
    unittest.main()
