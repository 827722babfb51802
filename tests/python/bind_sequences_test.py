import fractions
import pathlib
import tempfile
import unittest

import numpy as np
import pleat
import take

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


class SequenceTest(unittest.TestCase):
    def test_arrays_go_in_and_come_out(self):
        positions = np.stack([TETRAHEDRON, TETRAHEDRON + 1])
        sequence = pleat.Sequence(positions, FACES, fps=fractions.Fraction(30000, 1001), name="t")
        self.assertEqual((len(sequence), sequence.num_vertices, sequence.name), (2, 4, "t"))
        self.assertEqual(sequence.fps, fractions.Fraction(30000, 1001))
        np.testing.assert_array_equal(sequence.positions, positions)
        np.testing.assert_array_equal(sequence.frame(1), positions[1])
        np.testing.assert_array_equal(sequence.triangles, FACES)
        self.assertEqual(sequence.positions.dtype, np.float32)
        self.assertEqual(sequence.subset([1]).num_frames, 1)

    def test_faces_may_have_any_sizes(self):
        quad = pleat.Sequence(TETRAHEDRON[None], [0, 1, 2, 3, 0, 2, 1], face_sizes=[4, 3])
        np.testing.assert_array_equal(quad.face_sizes, [4, 3])
        np.testing.assert_array_equal(quad.corners, [0, 1, 2, 3, 0, 2, 1])
        self.assertEqual(len(quad.triangles), 3)

    def test_other_types_and_layouts_are_converted(self):
        positions = np.asfortranarray(np.stack([TETRAHEDRON] * 3).astype(np.float64))[::-1]
        np.testing.assert_array_equal(pleat.Sequence(positions, FACES).positions, positions)

    def test_bad_arrays_are_errors_with_words(self):
        for positions, faces, words in (
                (TETRAHEDRON, FACES, r"positions has the shape \(4, 3\)"),
                (TETRAHEDRON[None, :, :2], FACES, "shape"),
                (TETRAHEDRON[None], [[0, 1, 9]], "9"),
                (TETRAHEDRON[None] * np.nan, FACES, "frame 0"),
                (np.zeros((0, 4, 3)), FACES, "frame")):
            with self.assertRaisesRegex(pleat.Error, words):
                pleat.Sequence(positions, faces)
        with self.assertRaises(IndexError):
            take.performer().frame(1000)
        with self.assertRaises(IndexError):
            take.performer().subset([0, -1])

    def test_files_are_read_with_notes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "t.obj"
            path.write_text("".join("v %g %g %g\n" % tuple(row) for row in TETRAHEDRON) + "f 1 2 3\nf 1 2\n")
            notes = []
            sequence = pleat.read(path, fps=24, notes=notes)
            self.assertEqual(sequence.fps, 24)
            np.testing.assert_array_equal(sequence.frame(0), TETRAHEDRON)
            self.assertEqual(len(notes), 1)
        with self.assertRaisesRegex(pleat.Error, "t.obj") as raised:
            pleat.read(path)
        self.assertEqual(raised.exception.code, "NOT_FOUND")


if __name__ == "__main__":
    unittest.main()
