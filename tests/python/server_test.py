"""The verbs of the package on a real server: the same arrays and words as in process.

usage: server_test.py PLEATD
"""

import asyncio
import socket
import sys
import tempfile
import threading
import unittest

import numpy as np
import pleat
import take

try:
    import grpc
    import pleat.server
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(77)
from concurrent import futures

from pleat.server import _frames
from pleat.v1 import pose_service_pb2
from server_process import ServerProcess

PLEATD = sys.argv.pop(1)


def run(coroutine_function):
    """A test method that is a coroutine, with a server for `self.server`."""
    def test(self):
        async def main():
            async with pleat.server.connect(self.process.address) as self.server:
                await asyncio.wait_for(coroutine_function(self), 300)
        asyncio.run(main())
    return test


class ServerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.process = ServerProcess(PLEATD, cls.folder.name)
        cls.model_id = asyncio.run(cls.train())

    @classmethod
    def tearDownClass(cls):
        cls.process.stop()
        cls.folder.cleanup()

    @classmethod
    async def train(cls):
        cls.seen = []
        async with pleat.server.connect(cls.process.address) as server:
            cls.sequence_id = await server.upload(take.performer())
            return await server.train(cls.sequence_id, name="dancer", learner="gp",
                                      progress=lambda stage, share: cls.seen.append((stage, share)))

    def test_progress_grows_to_the_end(self):
        shares = [share for _, share in self.seen]
        self.assertEqual(shares, sorted(shares))
        self.assertEqual(shares[-1], 1)

    @run
    async def test_a_model_has_the_bytes_of_one_that_was_trained_here(self):
        shares = []
        character = await self.server.download(self.model_id, progress=lambda stage, share: shares.append(share))
        self.assertEqual(shares[-1], 1)
        here = pleat.train(pleat.Sequence.from_bytes(take.performer().to_bytes()), learner="gp")
        names = (character.joint_names, here.joint_names)
        self.assertEqual(names[0], names[1])
        motion = take.motion()
        np.testing.assert_array_equal(character.evaluate(motion)[0], here.evaluate(motion)[0])
        self.assertEqual([(m.id, m.name, m.num_vertices) for m in await self.server.models()],
                         [(self.model_id, "dancer", take.performer().num_vertices)])

    @run
    async def test_the_same_content_is_stored_once(self):
        self.assertEqual(await self.server.upload(take.performer()), self.sequence_id)
        self.assertEqual([s.id for s in await self.server.sequences()].count(self.sequence_id), 1)

    @run
    async def test_frames_are_those_of_this_process(self):
        character, motion = await self.server.download(self.model_id), take.motion()
        expected, expected_confidence = character.evaluate(motion)
        for options, most_mm in (({"content": "parameters", "character": character}, .003),
                                 ({"position_bits": 20}, .01), ({"encoding": "points", "position_bits": 16}, .1),
                                 ({"encoding": "mesh", "position_bits": 16}, .1), ({"max_error_mm": 1}, 1.01)):
            found, confidence = await self.server.evaluate(self.model_id, motion, **options)
            self.assertEqual(found.shape, expected.shape)
            furthest = 1000 * np.linalg.norm(found - expected, axis=2).max()
            self.assertLess(furthest, most_mm, options)
            np.testing.assert_allclose(confidence, expected_confidence, atol=1e-6)
        skinned, _ = await self.server.evaluate(self.model_id, motion, skinned_only=True, position_bits=20)
        np.testing.assert_allclose(skinned, character.evaluate(motion, skinned_only=True)[0], atol=1e-5)

    @run
    async def test_predict_and_show_are_the_two_halves(self):
        character, motion = await self.server.download(self.model_id), take.motion()
        roots, rotations, coefficients, _ = await self.server.predict(self.model_id, motion)
        self.assertEqual(coefficients.shape, (len(motion), character.num_coefficients))
        shown = character.show(roots, rotations, coefficients)
        np.testing.assert_allclose(shown, character.evaluate(motion)[0], atol=3e-6)

    @run
    async def test_a_live_session_answers_every_pose_while_others_are_sent(self):
        motion, character = take.motion(), await self.server.download(self.model_id)
        expected, _ = character.evaluate(motion)
        roots, rotations = motion.root_positions, motion.rotations
        async with self.server.session(self.model_id, position_bits=20) as session:
            self.assertEqual(session.num_vertices, character.num_vertices)

            async def send():
                for t in range(1, len(motion)):
                    order = [t, t - 1]
                    await session.send(t, roots[order], rotations[order])
                await session.done()
            sending = asyncio.create_task(send())
            frames = [frame async for frame in session]
            await sending
        self.assertEqual([frame.number for frame in frames], list(range(1, len(motion))))
        for frame in frames:
            self.assertLess(1000 * np.abs(frame.positions - expected[frame.number]).max(), .01)
            self.assertGreater(frame.evaluate_us, 0)

    @run
    async def test_the_latest_pose_wins(self):
        motion = take.motion()
        async with self.server.session(self.model_id, latest_wins=True, max_in_flight=1) as session:
            out = np.empty((session.num_vertices, 3), np.float32)
            for t in range(len(motion)):
                await session.send(t, motion.root_positions[t], motion.rotations[t])
            answered = []
            while not answered or answered[-1] != len(motion) - 1:
                frame = await session.receive(out=out)
                self.assertIs(frame.positions, out)
                answered.append(frame.number)
        self.assertEqual(answered, sorted(answered))

    @run
    async def test_a_pose_that_cannot_be_shown_raises_and_the_session_goes_on(self):
        motion = take.motion()
        async with self.server.session(self.model_id) as session:
            await session.send(1, motion.root_positions[0], np.zeros_like(motion.rotations[0]))
            with self.assertRaises(pleat.server.ServerError) as caught:
                await session.receive()
            self.assertEqual(caught.exception.code, "INVALID_ARGUMENT")
            self.assertIn("pose 1", str(caught.exception))
            await session.send(2, motion.root_positions[0], motion.rotations[0])
            self.assertEqual((await session.receive()).number, 2)

    @run
    async def test_compression_is_that_of_this_process(self):
        compressed_id = await self.server.compress(self.sequence_id, max_error_mm=1)
        data = await self.server.download_compressed(compressed_id)
        self.assertEqual(data, pleat.compress(take.performer(), max_error_mm=1)[0])
        expected = pleat.decompress(data)
        whole = await self.server.decompress(compressed_id)
        np.testing.assert_array_equal(whole.positions, expected.positions)
        self.assertEqual(whole.fps, expected.fps)
        part = await self.server.decompress(compressed_id, 7, 12)
        np.testing.assert_array_equal(part.positions, expected.positions[7:12])
        with self.assertRaises(pleat.Error):
            await self.server.compress(self.sequence_id)

    @run
    async def test_errors_have_code_and_words(self):
        for call, code, word in (
                (self.server.download("0" * 64), "NOT_FOUND", "0000"),
                (self.server.evaluate("0" * 64, take.motion()), "NOT_FOUND", "0000"),
                (self.server.train("0" * 64), "NOT_FOUND", "0000"),
                (self.server.train(self.sequence_id, learner="magic"), "INVALID_ARGUMENT", "magic"),
                (self.server.train(self.sequence_id, magic=3), "INVALID_ARGUMENT", "docs/options.md"),
                (self.server.job("no job"), "NOT_FOUND", "no job"),
                (self.server.evaluate(self.model_id, take.motion(), content="sound"), "INVALID_ARGUMENT", "sound")):
            with self.assertRaises(pleat.Error) as caught:
                await call
            self.assertIsInstance(caught.exception, pleat.server.ServerError)
            self.assertEqual(caught.exception.code, code)
            self.assertIn(word, str(caught.exception))

    @run
    async def test_who_cancels_a_training_cancels_its_job(self):
        def stop(stage, share):
            raise KeyError("enough")
        with self.assertRaises(KeyError):
            await self.server.train(self.sequence_id, learner="gp", seed=5, progress=stop)
        job = (await self.server.jobs())[-1]
        async for job in self.server.watch(job.id):
            pass
        self.assertIn(job.state, ("cancelled", "succeeded"))  # a short one may have ended first


class OtherServersTest(unittest.TestCase):
    def refused(self, address, code, word, **options):
        async def main():
            async with pleat.server.connect(address, connect_seconds=2, **options):
                pass
        with self.assertRaises(pleat.server.ServerError) as caught:
            asyncio.run(main())
        self.assertEqual(caught.exception.code, code)
        self.assertIn(word, str(caught.exception))

    def test_nobody_there(self):
        with socket.socket() as taken:  # bound, and nobody listens
            taken.bind(("127.0.0.1", 0))
            self.refused(f"127.0.0.1:{taken.getsockname()[1]}", "UNAVAILABLE", "start one with `pleatd`")

    def test_a_server_of_another_kind_is_refused_with_words(self):
        server = grpc.server(futures.ThreadPoolExecutor(1))
        port = server.add_insecure_port("127.0.0.1:0")
        server.start()
        try:
            self.refused(f"127.0.0.1:{port}", "UNIMPLEMENTED", "no Pleat server, or one of another version")
        finally:
            server.stop(None)

    def test_a_token_needs_tls(self):
        self.refused("example.org:7320", "INVALID_ARGUMENT", "without TLS", token="secret")


class FramesTest(unittest.TestCase):
    def test_packed_coefficients_that_are_damaged_are_errors(self):
        import zlib
        packed = zlib.compress(bytes([2, 1, 0x80, 1]))
        np.testing.assert_allclose(_frames.unpack_coefficients(packed), [.0005, -.0005, .032])
        for damaged in (b"", b"no", packed[:-3], zlib.compress(b"\x80"), zlib.compress(b"\x80" * 9),
                        zlib.compress(bytes(30000))):
            with self.assertRaises(pleat.server.ServerError) as caught:
                _frames.unpack_coefficients(damaged)
            self.assertEqual(caught.exception.code, "DATA_LOSS")

    def test_hostile_headers_and_frames_are_errors(self):
        header = pose_service_pb2.StreamHeader(num_vertices=1 << 30, num_points=1 << 30, num_triangles=1)
        with self.assertRaises(pleat.Error):
            _frames.FrameReader(header, None)
        header = pose_service_pb2.StreamHeader(content=pose_service_pb2.STREAM_CONTENT_PARAMETERS)
        with self.assertRaises(pleat.Error):
            _frames.FrameReader(header, None)
        reader = _frames.FrameReader(header, take.character())
        for rotations in ([], [1.0] * 7, [float("nan")] * 72, [1.0, 0, 0, 0] * 5):
            frame = pose_service_pb2.Frame(parameters=pose_service_pb2.FrameParameters(rotations=rotations))
            with self.assertRaises(pleat.Error):
                reader.positions(frame)


if __name__ == "__main__":
    unittest.main()
