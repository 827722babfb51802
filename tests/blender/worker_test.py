"""The thread between the interface and the mesh: newest first, errors as results, a server that goes and comes."""

import tempfile
import threading
import unittest

import numpy as np
from addon import CHARACTER, PLEATD
from server_process import ServerProcess

from pleat_blender import axes, heat, service
from pleat_blender.character import Character, Evaluator
from pleat_blender.library import PleatError
from pleat_blender.worker import InProcess, OnServer, Request, Worker

MODEL = (CHARACTER / "character.pleat").read_bytes()
PATIENCE = 30.0  # seconds, of a test that waits for what must come


def request(number, character, **options):
    rotations = np.zeros((1, character.num_joints, 4))
    rotations[..., 3] = 1
    return Request(number, character.joint_positions[:1].copy(), rotations, **options)


class WorkerTest(unittest.TestCase):
    def setUp(self):
        self.character = Character(MODEL)
        self.weights = heat.vertex_weights(self.character.influences(), self.character.num_joints)

    def test_a_request_becomes_positions_in_blenders_axes_and_colors(self):
        worker = Worker(lambda: InProcess(self.character), self.weights)
        worker.submit(request(1, self.character, with_heat=True))
        result = worker.take(1, PATIENCE)
        expected = np.empty((self.character.num_vertices, 3), np.float32)
        asked = request(1, self.character)
        confidence = Evaluator(self.character).evaluate(asked.roots, asked.rotations, expected)
        np.testing.assert_array_equal(result.positions, axes.to_blender(expected))
        self.assertEqual(result.confidence, confidence)
        self.assertEqual(result.colors.shape, (self.character.num_vertices, 4))
        self.assertIsNone(worker.take())
        worker.stop()
        self.assertFalse(worker.is_alive())

    def test_the_newest_request_replaces_those_that_wait(self):
        held, seen = threading.Event(), []

        class Slow(InProcess):
            def frame(self, asked, out):
                seen.append(asked.number)
                held.wait(PATIENCE)
                return super().frame(asked, out)
        worker = Worker(lambda: Slow(self.character))
        for number in range(1, 50):
            worker.submit(request(number, self.character))
        held.set()
        self.assertEqual(worker.take(49, PATIENCE).number, 49)
        self.assertLessEqual(len(seen), 2)
        worker.stop()

    def test_what_goes_wrong_is_a_result_and_the_thread_goes_on(self):
        worker = Worker(lambda: InProcess(self.character))
        bad = request(1, self.character)
        bad.rotations[:] = np.nan
        worker.submit(bad)
        self.assertIn("unit quaternions", str(worker.take(1, PATIENCE).error))
        worker.submit(request(2, self.character))
        self.assertIsNone(worker.take(2, PATIENCE).error)
        worker.stop()

    def test_a_server_that_is_away_is_said_at_once_and_asked_again(self):
        source = OnServer(self.character, "127.0.0.1:1", "m")
        with self.assertRaises(PleatError) as first:
            source.frame(request(1, self.character), np.empty((self.character.num_vertices, 3), np.float32))
        self.assertEqual(first.exception.code, "UNAVAILABLE")
        with self.assertRaises(PleatError) as second:
            source.frame(request(2, self.character), np.empty((self.character.num_vertices, 3), np.float32))
        self.assertIs(second.exception, first.exception)  # without another attempt


class ServiceTest(unittest.TestCase):
    """Upload, training, download and sessions on a real server."""

    def test_the_whole_way(self):
        with tempfile.TemporaryDirectory() as folder, ServerProcess(PLEATD, folder) as process:
            server = service.Server(process.address)
            self.assertEqual(server.models(), [])
            take = service.Take.of_file(performer(folder))
            self.assertEqual((take.num_frames, take.frame_rate), (24, 30))
            stages = []
            sequence = server.upload(take, lambda stage, fraction: stages.append(stage))
            self.assertIn("upload", stages)
            job = server.train([sequence], "dancer", {"learner": "gp"})
            seen = []
            model = server.watch(job, lambda state, stage, fraction, eta: seen.append((state, fraction)))
            self.assertEqual(seen[-1], ("succeeded", 1))
            data = server.download(model)
            self.assertEqual([entry["name"] for entry in server.models()], ["dancer"])
            self.check_session(process.address, model, Character(data))

            with self.assertRaises(PleatError) as caught:
                server.train([sequence], options={"learner": "magic"})
            self.assertIn("magic", str(caught.exception))
            with self.assertRaises(PleatError) as caught:
                server.download("0" * 64)
            self.assertEqual(caught.exception.code, "NOT_FOUND")

            def refuse(stage, fraction):
                raise KeyError("the interface has closed")
            with self.assertRaises(KeyError):
                server.watch(server.train([sequence], options={"seed": 9, "learner": "gp"}),
                             lambda *state: refuse("", 0))

    def check_session(self, address, model, character):
        asked = request(1, character)
        expected, found = (np.empty((character.num_vertices, 3), np.float32) for _ in range(2))
        confidence = Evaluator(character).evaluate(asked.roots, asked.rotations, expected)
        for content, most_mm in ((service.CONTENT_PARAMETERS, .003), (service.CONTENT_MESH, .01)):
            session = service.Session(address, model, content=content, position_bits=20)
            self.assertAlmostEqual(session.frame(asked.roots, asked.rotations, found), confidence, places=5)
            self.assertLess(1000 * np.abs(found - expected).max(), most_mm)


def performer(folder):
    import os
    import subprocess
    subprocess.run([os.path.join(os.environ["PLEAT_BIN"], "pleat"), "generate", "performer", "-o", f"{folder}/made",
                    "--frames", "24", "--vertices", "700"], check=True, capture_output=True)
    return f"{folder}/made/performer.pc2"


if __name__ == "__main__":
    unittest.main()
