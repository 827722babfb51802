import threading
import unittest

import numpy as np
import pleat
import take


class CharacterObjectTest(unittest.TestCase):
    def test_poses_with_history_are_the_frames_of_the_motion(self):
        expected, confidence = take.character().evaluate(take.motion())
        frames = np.arange(1, 30)
        positions, likeness = take.character().evaluate_poses(*take.queries(frames))
        np.testing.assert_array_equal(positions, expected[frames])
        np.testing.assert_array_equal(likeness, confidence[frames])

    def test_out_is_written_and_returned(self):
        character = take.character()
        frames = [3, 4, 5]
        expected, _ = character.evaluate_poses(*take.queries(frames))
        room = np.full((9, character.num_vertices, 3), 7, np.float32)
        out = room[2:5]
        positions, _ = character.evaluate_poses(*take.queries(frames), out=out)
        self.assertIs(positions, out)
        np.testing.assert_array_equal(room[2:5], expected)
        self.assertTrue((room[:2] == 7).all() and (room[5:] == 7).all())
        clip = np.empty((len(take.motion()), character.num_vertices, 3), np.float32)
        self.assertIs(character.evaluate(take.motion(), out=clip)[0], clip)

    def test_out_that_does_not_fit_is_refused(self):
        character = take.character()
        good = np.zeros((2, character.num_vertices, 3), np.float32)
        read_only = good.copy()
        read_only.flags.writeable = False
        for out in (good[:1], good.astype(np.float64), good[:, :, ::-1], read_only, good.tolist(),
                    np.zeros((2, 3, character.num_vertices), np.float32).transpose(0, 2, 1)):
            with self.assertRaisesRegex(pleat.Error, "out"):
                character.evaluate_poses(*take.queries([3, 4]), out=out)

    def test_parameters_show_the_frame_within_two_micrometers(self):
        character = take.character()
        roots, rotations, coefficients, confidence = character.predict(*take.queries([7, 8]))
        self.assertEqual(coefficients.shape, (2, character.num_coefficients))
        self.assertEqual(rotations.dtype, np.float32)
        positions, likeness = character.evaluate_poses(*take.queries([7, 8]))
        shown = character.show(roots, rotations, coefficients)
        np.testing.assert_allclose(shown, positions, atol=2e-6)
        np.testing.assert_array_equal(confidence, likeness)
        _, _, none, _ = character.predict(*take.queries([7]), skinned_only=True)
        self.assertEqual(none.shape, (1, 0))

    def test_bone_scales_change_the_proportions(self):
        character = take.character()
        scales = np.ones(18)
        scales[character.joint_names.index("leftFoot")] = 1.5
        plain, _ = character.evaluate_poses(*take.queries([5]))
        scaled, _ = character.evaluate_poses(*take.queries([5]), bone_scales=scales)
        self.assertFalse(np.array_equal(plain, scaled))
        with self.assertRaisesRegex(pleat.Error, "bone scale"):
            character.evaluate_poses(*take.queries([5]), bone_scales=[1, 2])

    def test_bad_poses_are_errors_with_words(self):
        character = take.character()
        roots, rotations = take.queries([3, 4])
        for bad_roots, bad_rotations, words in (
                (roots, rotations[:, :, :5], "rotations has the shape"),
                (roots[:1], rotations, "root_positions has the shape"),
                (roots, rotations * 2, "query 0.*joint 0"),
                (roots * np.nan, rotations, "query 0"),
                (roots[:, :0], rotations[:, :0], "at least one pose")):
            with self.assertRaisesRegex(pleat.Error, words):
                character.evaluate_poses(bad_roots, bad_rotations)
        with self.assertRaisesRegex(pleat.Error, "another model"):
            character.show(roots[:, 0], rotations[:, 0], np.zeros((2, 3)))
        with self.assertRaisesRegex(pleat.Error, "joints"):
            character.evaluate(pleat.Motion(roots[:, 0], rotations[:, 0, :4]))

    def test_threads_share_a_character(self):
        character, failures = take.character(), []
        expected, _ = character.evaluate(take.motion())

        def evaluate():
            for _ in range(5):
                if not np.array_equal(character.evaluate(take.motion())[0], expected):
                    failures.append("differs")

        threads = [threading.Thread(target=evaluate) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])


if __name__ == "__main__":
    unittest.main()
