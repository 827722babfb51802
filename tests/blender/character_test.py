"""The ctypes classes against frames of our own evaluator, and on hostile bytes."""

import random
import unittest

import numpy as np
from addon import CHARACTER

from pleat_blender import heat
from pleat_blender.character import Character, Evaluator
from pleat_blender.library import PleatError, evaluating

MODEL = (CHARACTER / "character.pleat").read_bytes()


class CharacterTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.character = Character(MODEL)
        joints = cls.character.num_joints
        cls.poses = np.fromfile(CHARACTER / "poses.f64").reshape(-1, 3 + 4 * joints)
        cls.frames = np.fromfile(CHARACTER / "frames.f32", np.float32).reshape(len(cls.poses), -1, 3)

    def query(self, t):
        order = [t, t - 1] if t else [t]
        return (np.ascontiguousarray(self.poses[order, :3]),
                np.ascontiguousarray(self.poses[order, 3:].reshape(len(order), -1, 4)))

    def test_frames_are_our_own_to_the_bit(self):
        evaluator = Evaluator(self.character)
        out = np.empty((self.character.num_vertices, 3), np.float32)
        for t in range(len(self.poses)):
            evaluator.evaluate(*self.query(t), out)
            np.testing.assert_array_equal(out, self.frames[t])

    def test_strength_goes_from_skinning_through_the_learned_detail_and_beyond(self):
        evaluator = Evaluator(self.character)
        shown = {}
        for strength in (0, .5, 1, 2):
            shown[strength] = np.empty((self.character.num_vertices, 3), np.float32)
            evaluator.evaluate(*self.query(9), shown[strength], strength)
        detail = shown[1] - shown[0]
        self.assertGreater(np.abs(detail).max(), .001)
        np.testing.assert_allclose(shown[.5], shown[0] + .5 * detail, atol=1e-6)
        np.testing.assert_allclose(shown[2], shown[0] + 2 * detail, atol=1e-6)

    def test_what_a_package_needs_is_there(self):
        character = self.character
        self.assertEqual(character.joint_names, ["hips", "chest", "head"])
        self.assertEqual(character.parents, [-1, 0, 1])
        self.assertEqual(character.learner, "gp")
        self.assertEqual(character.warnings, ["made by a test"])
        self.assertEqual(character.face_sizes.sum(), len(character.corners))
        bones, weights = character.influences()
        np.testing.assert_allclose(weights.sum(1), 1, atol=1e-5)
        self.assertEqual(set(bones[weights > 0].tolist()), {1, 2})
        dense = heat.vertex_weights((bones, weights), 3)
        np.testing.assert_allclose(dense.sum(1), 1, atol=1e-5)

    def test_confidence_of_joints_becomes_colors(self):
        confidence = self.character.joint_confidence(*self.query(9))
        self.assertEqual(confidence[0], 1)
        self.assertTrue(((confidence >= 0) & (confidence <= 1)).all())
        np.testing.assert_allclose(heat.colors(np.array([0, .5, 1, 2, -1])),
                                   heat.SCALE[[0, 1, 2, 2, 0]], atol=1e-6)

    def test_damaged_models_are_errors_with_words(self):
        chance = random.Random(5)
        for _ in range(200):
            damaged = bytearray(MODEL[:chance.randrange(len(MODEL))])
            for _ in range(chance.randrange(4)):
                if damaged:
                    damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
            with self.assertRaises(PleatError) as caught:
                Character(bytes(damaged))
            self.assertGreater(len(str(caught.exception)), 10)
            self.assertIn(caught.exception.code, ("INVALID_ARGUMENT", "DATA_LOSS", "RESOURCE_EXHAUSTED"))

    def test_poses_that_do_not_fit_are_errors(self):
        evaluator = Evaluator(self.character)
        out = np.empty((self.character.num_vertices, 3), np.float32)
        roots, rotations = self.query(3)
        for bad in (np.full_like(rotations, np.nan), np.zeros_like(rotations), rotations[:, :2].copy()):
            with self.assertRaises(PleatError):
                evaluator.evaluate(roots, bad, out)

    def test_the_library_says_its_version(self):
        self.assertRegex(evaluating().version, r"^\d+\.\d+\.\d+$")


if __name__ == "__main__":
    unittest.main()
