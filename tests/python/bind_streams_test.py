"""The decoder of streams on what a hostile server might say; frames of a real one are in server_test.py."""

import random
import threading
import unittest

import numpy as np
import pleat
from pleat._pleat import StreamDecoder


def header(**changes):
    fields = {"encoding": 2, "num_vertices": 4, "num_points": 4, "num_triangles": 4, "origin": (0, 0, 0), "range": 1,
              "bits": 12, "topology": b"DRACO\x02\x02\x01\x00\x00\x00" + bytes(60), "vertex_order": [0, 1, 2, 3]}
    return {**fields, **changes}


class StreamDecoderTest(unittest.TestCase):
    def test_headers_that_make_no_sense_are_errors(self):
        for changes in ({"encoding": 9}, {"num_vertices": -1}, {"num_vertices": 1 << 30}, {"bits": 40}, {"range": 0.0},
                        {"range": float("nan")}, {"topology": b""}, {"topology": b"no mesh"},
                        {"vertex_order": [0, 0, 0, 0]}, {"vertex_order": [0, 1, 2, 9]}):
            with self.assertRaises(pleat.Error) as caught:
                StreamDecoder(**header(**changes))
            self.assertGreater(len(str(caught.exception)), 10)

    def test_damaged_topologies_are_errors(self):
        chance = random.Random(3)
        for _ in range(200):
            topology = bytearray(header()["topology"])
            for _ in range(6):
                topology[chance.randrange(len(topology))] = chance.randrange(256)
            with self.assertRaises(pleat.Error):
                StreamDecoder(**header(topology=bytes(topology)))


class SequenceBytesTest(unittest.TestCase):
    def test_a_sequence_survives_its_bytes(self):
        take = pleat.performer(3, 600)
        back = pleat.Sequence.from_bytes(take.to_bytes())
        np.testing.assert_array_equal(back.positions, take.positions)
        self.assertEqual((back.fps, back.name), (take.fps, take.name))
        self.assertEqual(back.to_bytes(), take.to_bytes())

    def test_damaged_bytes_are_errors(self):
        data, chance = pleat.performer(2, 600).to_bytes(), random.Random(2)
        for _ in range(100):
            damaged = bytearray(data)
            damaged[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
            with self.assertRaises(pleat.Error):
                pleat.Sequence.from_bytes(bytes(damaged[:chance.randrange(1, len(data) + 1)]))

    def test_threads_may_encode_at_once(self):
        take, found = pleat.performer(2, 600), []
        threads = [threading.Thread(target=lambda: found.append(take.to_bytes())) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(set(found)), 1)


if __name__ == "__main__":
    unittest.main()
