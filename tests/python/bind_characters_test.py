import pathlib
import tempfile
import unittest

import numpy as np
import pleat
import take


class CharacterTest(unittest.TestCase):
    def test_training_shows_the_take_again(self):
        positions, confidence = take.character().evaluate(take.motion())
        error = np.linalg.norm(positions - take.performer().positions, axis=2).mean()
        self.assertLess(error, .003)
        self.assertGreater(confidence.min(), .5)
        skinned, _ = take.character().evaluate(take.motion(), skinned_only=True)
        self.assertGreater(np.linalg.norm(skinned - take.performer().positions, axis=2).mean(), error)

    def test_tells_what_it_is(self):
        character = take.character()
        self.assertEqual(character.num_vertices, take.performer().num_vertices)
        self.assertEqual((character.num_joints, len(character.joint_names), len(character.parents)), (18, 18, 18))
        self.assertEqual(character.joint_positions.shape, (18, 3))
        np.testing.assert_array_equal(character.triangles, take.performer().triangles)
        self.assertEqual(character.record["learner"], "gp")
        self.assertEqual(character.fps, 30)

    def test_files_keep_the_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "c.pleat"
            pleat.save(take.character(), path)
            self.assertEqual(pleat.load(path).to_bytes(), path.read_bytes())

    def test_other_files_and_later_versions_are_refused_with_words(self):
        data = take.character().to_bytes()
        for damaged, words in ((b"o cube", "model file"), (data[:8] + b"\x63" + data[9:], "version 99|corrupt|checksum"),
                               (data[:-50], "cut off|corrupt|checksum")):
            with self.assertRaisesRegex(pleat.Error, words):
                pleat.Character.from_bytes(damaged)

    def test_options_are_those_of_the_page(self):
        with self.assertRaisesRegex(pleat.Error, "no_such_option"):
            pleat.train(take.performer(), no_such_option=1)
        with self.assertRaisesRegex(pleat.Error, "history"):
            pleat.train(take.performer(), history=99)
        with self.assertRaises(pleat.Error):
            pleat.train([])

    def test_the_same_seed_gives_the_same_bytes(self):
        self.assertEqual(pleat.train(take.performer(), learner="gp", threads=1).to_bytes(),
                         take.character().to_bytes())


if __name__ == "__main__":
    unittest.main()
