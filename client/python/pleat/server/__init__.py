"""Pleat on a server: the verbs of the package, as coroutines.

    async with pleat.server.connect("127.0.0.1:7320") as server:
        sequence = await server.upload(take)
        model = await server.train(sequence, learner="gp", progress=print)
        positions, confidence = await server.evaluate(model, motion)

Arrays are those of the package: positions V x 3 float32 in meters, rotations x, y, z, w. What goes wrong raises
ServerError, a pleat.Error, with a `code` and what to do. Needs grpcio and protobuf (Debian: python3-grpcio,
python3-protobuf).
"""

from __future__ import annotations

import asyncio
import dataclasses
import secrets
from collections.abc import AsyncIterator, Iterable
from fractions import Fraction
from types import TracebackType
from typing import Any

try:
    import grpc
    import grpc.aio
    from ..v1 import (common_pb2, compressed_sequence_service_pb2, compressed_sequence_service_pb2_grpc,
                      compression_pb2, job_service_pb2, job_service_pb2_grpc, model_service_pb2,
                      model_service_pb2_grpc, pose_service_pb2, pose_service_pb2_grpc, sequence_service_pb2,
                      sequence_service_pb2_grpc, training_pb2)
except ImportError as error:
    raise ImportError(f"pleat.server needs grpcio and protobuf ({error}); install python3-grpcio and python3-protobuf, "
                      "or `pip install pleat[server]`") from error

import numpy as np
import numpy.typing as npt

from .. import Character, Motion, ProgressFunction, Sequence
from . import _transfer
from ._errors import ServerError, another_version, translated, unavailable
from ._frames import FrameReader, parameters_of, pose_message, stream_options
from ._session import LiveFrame, LiveSession

__all__ = ["Job", "LiveFrame", "LiveSession", "Server", "ServerError", "connect"]

STATES = {job_service_pb2.JOB_STATE_QUEUED: "queued", job_service_pb2.JOB_STATE_RUNNING: "running",
          job_service_pb2.JOB_STATE_SUCCEEDED: "succeeded", job_service_pb2.JOB_STATE_FAILED: "failed",
          job_service_pb2.JOB_STATE_CANCELLED: "cancelled"}
FINAL = ("succeeded", "failed", "cancelled")
MOST_RECEIVED_BYTES = 64 << 20
CALL_SECONDS = 60.0


@dataclasses.dataclass(frozen=True)
class Job:
    """A training or compression at one moment."""

    id: str
    state: str  # queued, running, succeeded, failed or cancelled
    stage: str
    fraction: float  # of the whole job, 0 to 1
    eta_seconds: float | None
    warnings: list[str]
    result_id: str  # of the model or compressed sequence, when it has succeeded
    error: ServerError | None


def _job_of(message: job_service_pb2.Job) -> Job:
    error = None
    if message.HasField("error"):
        names = {code.value[0]: code.name for code in grpc.StatusCode}
        error = ServerError(names.get(message.error.code, "UNKNOWN"), message.error.message)
    return Job(message.id, STATES.get(message.state, "unknown"), message.stage, message.fraction,
               message.eta_seconds if message.HasField("eta_seconds") else None, list(message.warnings),
               message.result_id, error)


def _is_this_machine(address: str) -> bool:
    host = address.rpartition(":")[0].strip("[]")
    return address.startswith("unix:") or host in ("localhost", "::1") or host.startswith("127.")


def connect(address: str = "127.0.0.1:7320", *, token: str = "", tls: bool = False,
            root_certificates: bytes | None = None, connect_seconds: float = 5) -> Server:
    """A server, for `async with`. address: HOST:PORT or unix:PATH. root_certificates: PEM; None: the system's."""
    return Server(address, token, tls or root_certificates is not None, root_certificates, connect_seconds)


class Server:
    """Made by `connect`. Tasks of one event loop may share it."""

    def __init__(self, address: str, token: str, tls: bool, root_certificates: bytes | None,
                 connect_seconds: float) -> None:
        if token and not tls and not _is_this_machine(address):
            raise ServerError("INVALID_ARGUMENT", f"a token is not sent to '{address}' without TLS, which others could "
                                                  "read: pass tls=True")
        self.address, self._connect_seconds = address, connect_seconds
        self._metadata = (("authorization", f"Bearer {token}"),) if token else ()
        self._tls, self._root_certificates = tls, root_certificates

    async def __aenter__(self) -> Server:
        options = [("grpc.max_receive_message_length", MOST_RECEIVED_BYTES), ("grpc.use_local_subchannel_pool", 1)]
        if self._tls:
            credentials = grpc.ssl_channel_credentials(self._root_certificates)
            self._channel = grpc.aio.secure_channel(self.address, credentials, options)
        else:
            self._channel = grpc.aio.insecure_channel(self.address, options)
        try:
            await self._check_server()
        except BaseException:
            await self._channel.close()
            raise
        self._sequences = sequence_service_pb2_grpc.SequenceServiceStub(self._channel)
        self._jobs = job_service_pb2_grpc.JobServiceStub(self._channel)
        self._models = model_service_pb2_grpc.ModelServiceStub(self._channel)
        self._poses = pose_service_pb2_grpc.PoseServiceStub(self._channel)
        self._compressed = compressed_sequence_service_pb2_grpc.CompressedSequenceServiceStub(self._channel)
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None,
                        trace: TracebackType | None) -> None:
        await self._channel.close()

    async def _check_server(self) -> None:
        """Asks the health service, which needs no token, for one of our services by its name and version."""
        check = self._channel.unary_unary("/grpc.health.v1.Health/Check")
        name = b"pleat.v1.PoseService"  # HealthCheckRequest with its field 1
        try:
            await asyncio.wait_for(self._channel.channel_ready(), self._connect_seconds)
            await check(b"\x0a" + bytes([len(name)]) + name, timeout=self._connect_seconds)
        except asyncio.TimeoutError as error:
            raise unavailable(self.address, f"within {self._connect_seconds} s") from error
        except grpc.RpcError as error:
            if error.code() in (grpc.StatusCode.UNIMPLEMENTED, grpc.StatusCode.NOT_FOUND):
                raise another_version(self.address, error.details() or "") from error
            with translated(self.address):
                raise

    async def _call(self, method: Any, request: Any) -> Any:
        with translated(self.address):
            return await method(request, metadata=self._metadata, timeout=CALL_SECONDS)

    # Takes ----------------------------------------------------------------------------------------------------------

    async def upload(self, sequence: Sequence, *, ttl_seconds: int = 0,
                     progress: ProgressFunction | None = None) -> str:
        """Stores a sequence and returns its id; the same content is stored once. ttl_seconds: 0 = for ever."""
        data = await asyncio.to_thread(sequence.to_bytes)
        response = await _transfer.upload(self._sequences.UploadSequence, self._sequences, data, self._metadata,
                                          self.address, ttl_seconds, progress)
        return str(response.sequence.id)

    async def sequences(self) -> list[sequence_service_pb2.Sequence]:
        return await self._pages(self._sequences.ListSequences, sequence_service_pb2.ListSequencesRequest, "sequences")

    async def delete_sequence(self, sequence_id: str) -> None:
        await self._call(self._sequences.DeleteSequence, sequence_service_pb2.DeleteSequenceRequest(id=sequence_id))

    async def _pages(self, method: Any, request: Any, field: str) -> list[Any]:
        found, token = [], ""
        while True:
            page = await self._call(method, request(page_token=token))
            found += getattr(page, field)
            if not page.next_page_token or page.next_page_token == token:
                return found
            token = page.next_page_token

    # Jobs -----------------------------------------------------------------------------------------------------------

    async def start_training(self, sequence_ids: str | Iterable[str], *, name: str = "", **options: Any) -> Job:
        """Puts a training into the queue. options: names of docs/options.md, for example learner="gp"."""
        ids = [sequence_ids] if isinstance(sequence_ids, str) else list(sequence_ids)
        try:
            chosen = training_pb2.TrainOptions(**options)
        except (TypeError, ValueError) as error:
            raise ServerError("INVALID_ARGUMENT", f"training options: {error}; docs/options.md has their names") \
                from error
        request = job_service_pb2.CreateTrainingJobRequest(sequence_ids=ids, options=chosen, model_name=name,
                                                           request_id=secrets.token_hex(16))
        return _job_of((await self._call(self._jobs.CreateTrainingJob, request)).job)

    async def train(self, sequence_ids: str | Iterable[str], *, name: str = "",
                    progress: ProgressFunction | None = None, **options: Any) -> str:
        """Trains to the end and returns the id of the model. Whoever cancels this cancels the job."""
        return await self._finish(await self.start_training(sequence_ids, name=name, **options), progress)

    async def _finish(self, job: Job, progress: ProgressFunction | None) -> str:
        try:
            async for job in self.watch(job.id):
                if progress:
                    progress(job.stage, job.fraction)
        except BaseException as error:  # a cancelled task, or what `progress` raised
            if not isinstance(error, ServerError):
                await asyncio.shield(self._cancel_quietly(job.id))
            raise
        if job.error is not None:
            raise job.error
        return job.result_id

    async def _cancel_quietly(self, job_id: str) -> None:
        try:
            await self.cancel(job_id)
        except ServerError:
            pass  # it has ended, or the server is away

    async def watch(self, job_id: str) -> AsyncIterator[Job]:
        """The job now and after every change, until it is final."""
        attempts = 0
        while True:
            try:
                call = self._jobs.WatchJob(job_service_pb2.WatchJobRequest(id=job_id), metadata=self._metadata)
                async for response in call:
                    attempts = 0
                    job = _job_of(response.job)
                    yield job
                    if job.state in FINAL:
                        return
                attempts += 1
            except grpc.RpcError as error:
                attempts += 1
                if error.code() not in _transfer.TRANSIENT or attempts >= _transfer.ATTEMPTS:
                    with translated(self.address):
                        raise
            if attempts >= _transfer.ATTEMPTS:
                raise ServerError("UNAVAILABLE", f"the server at '{self.address}' no longer says how job {job_id} is")
            await asyncio.sleep(.1 * 2 ** attempts)

    async def job(self, job_id: str) -> Job:
        return _job_of((await self._call(self._jobs.GetJob, job_service_pb2.GetJobRequest(id=job_id))).job)

    async def jobs(self) -> list[Job]:
        return [_job_of(job) for job in await self._pages(self._jobs.ListJobs, job_service_pb2.ListJobsRequest, "jobs")]

    async def cancel(self, job_id: str) -> None:
        await self._call(self._jobs.CancelJob, job_service_pb2.CancelJobRequest(id=job_id))

    # Models ---------------------------------------------------------------------------------------------------------

    async def models(self) -> list[model_service_pb2.Model]:
        return await self._pages(self._models.ListModels, model_service_pb2.ListModelsRequest, "models")

    async def download(self, model_id: str, *, progress: ProgressFunction | None = None) -> Character:
        """The character of a model, for use in this process."""
        data = await _transfer.download(
            self._models.DownloadModel,
            lambda offset: model_service_pb2.DownloadModelRequest(id=model_id, offset_bytes=offset),
            self._metadata, self.address, model_id, progress)
        return await asyncio.to_thread(Character.from_bytes, data)

    async def delete_model(self, model_id: str) -> None:
        await self._call(self._models.DeleteModel, model_service_pb2.DeleteModelRequest(id=model_id))

    # Poses ----------------------------------------------------------------------------------------------------------

    async def _stream(self, model_id: str, motion: Motion, options: pose_service_pb2.StreamOptions,
                      bone_scales: npt.ArrayLike, skinned_only: bool) -> AsyncIterator[Any]:
        track = common_pb2.PoseTrack(fps=motion.fps, poses=[
            pose_message(root, rotations) for root, rotations in zip(motion.root_positions, motion.rotations)])
        request = pose_service_pb2.EvaluateClipRequest(
            character=pose_service_pb2.Character(model_id=model_id, skinned_only=skinned_only,
                                                 bone_scales=np.asarray(bone_scales, float).tolist()),
            track=track, options=options)
        with translated(self.address):
            async for response in self._poses.EvaluateClip(request, metadata=self._metadata):
                yield response

    async def frames(self, model_id: str, motion: Motion, *, content: str = "mesh", encoding: str = "delta",
                     position_bits: int = 16, max_error_mm: float = 0, bone_scales: npt.ArrayLike = (),
                     skinned_only: bool = False,
                     character: Character | None = None) -> AsyncIterator[tuple[npt.NDArray[np.float32], float]]:
        """Positions (V x 3) and confidence, frame after frame, as fast as they are read.

        content: "mesh", "control" (a twentieth of the vertices) or "parameters" (under a kilobyte a frame, which
        `character`, the downloaded model, shows here). encoding: "delta", "points" or "mesh".
        """
        options, reader = stream_options(content, encoding, position_bits, max_error_mm), None
        async for response in self._stream(model_id, motion, options, bone_scales, skinned_only):
            if response.WhichOneof("part") == "header":
                reader = FrameReader(response.header, character)
            elif reader is None:
                raise ServerError("DATA_LOSS", f"the stream of '{self.address}' does not begin with a header")
            else:
                yield reader.positions(response.frame, bone_scales), response.frame.confidence

    async def evaluate(self, model_id: str, motion: Motion, **options: Any) -> tuple[npt.NDArray[np.float32],
                                                                                    npt.NDArray[np.float64]]:
        """All frames: T x V x 3 and T. options: those of `frames`."""
        found = [frame async for frame in self.frames(model_id, motion, **options)]
        return np.stack([positions for positions, _ in found]), np.array([confidence for _, confidence in found])

    async def predict(self, model_id: str, motion: Motion) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float32],
                                                                    npt.NDArray[np.float32], npt.NDArray[np.float64]]:
        """Root positions, rotations, coefficients and confidence of every frame, for Character.show."""
        found, confidence = [], []
        options = stream_options("parameters", "delta", 0, 0)
        async for response in self._stream(model_id, motion, options, (), False):
            if response.WhichOneof("part") == "frame":
                found.append(parameters_of(response.frame.parameters))
                confidence.append(response.frame.confidence)
        roots, rotations, coefficients = (np.stack(values) for values in zip(*found))
        return roots, rotations, coefficients, np.array(confidence)

    def session(self, model_id: str, *, content: str = "mesh", encoding: str = "delta", position_bits: int = 16,
                max_error_mm: float = 0, bone_scales: npt.ArrayLike = (), skinned_only: bool = False,
                character: Character | None = None, max_in_flight: int = 4, latest_wins: bool = False) -> LiveSession:
        """A live session, for `async with`. content and character: as for `frames`.

        latest_wins: a pose that waits is replaced by a newer one; otherwise every pose gets its frame.
        """
        start = pose_service_pb2.LiveSessionRequest.Start(
            character=pose_service_pb2.Character(model_id=model_id, skinned_only=skinned_only,
                                                 bone_scales=np.asarray(bone_scales, float).tolist()),
            options=stream_options(content, encoding, position_bits, max_error_mm), max_in_flight=max_in_flight,
            latest_wins=latest_wins)
        return LiveSession(self.address, self._poses.LiveSession(metadata=self._metadata), start, character)

    # Compression ----------------------------------------------------------------------------------------------------

    async def compress(self, sequence_id: str, *, max_error_mm: float | None = None, kg_percent: float | None = None,
                       grid_bits: int | None = None, progress: ProgressFunction | None = None) -> str:
        """Compresses an uploaded sequence with one promise and returns the id of the file."""
        goals = {"max_error_mm": max_error_mm, "kg_percent": kg_percent, "lossless_at_bits": grid_bits}
        given = {name: value for name, value in goals.items() if value is not None}
        if len(given) != 1:
            raise ServerError("INVALID_ARGUMENT", "give one of max_error_mm, kg_percent and grid_bits")
        request = job_service_pb2.CreateCompressionJobRequest(
            sequence_id=sequence_id, options=compression_pb2.CompressOptions(**given),
            request_id=secrets.token_hex(16))
        return await self._finish(_job_of((await self._call(self._jobs.CreateCompressionJob, request)).job), progress)

    async def download_compressed(self, compressed_id: str, *, progress: ProgressFunction | None = None) -> bytes:
        """The bytes of the .plt file, which pleat.decompress reads."""
        request = compressed_sequence_service_pb2.DownloadCompressedSequenceRequest
        return await _transfer.download(self._compressed.DownloadCompressedSequence,
                                        lambda offset: request(id=compressed_id, offset_bytes=offset),
                                        self._metadata, self.address, compressed_id, progress)

    async def decompress(self, compressed_id: str, begin: int = 0, end: int = 0) -> Sequence:
        """The frames begin to end - 1, decoded on the server; end 0 = all that follow."""
        request = compressed_sequence_service_pb2.DecodeFramesRequest(id=compressed_id, begin_frame=begin,
                                                                      end_frame=end)
        shape, frames = bytearray(), {}
        with translated(self.address):
            async for part in self._compressed.DecodeFrames(request, metadata=self._metadata):
                if part.WhichOneof("part") == "shape":
                    shape += part.shape
                else:
                    frames.setdefault(part.positions.frame, bytearray()).extend(part.positions.xyz)
        first = Sequence.from_bytes(bytes(shape))
        wanted = 12 * first.num_vertices
        for frame, data in frames.items():
            if len(data) != wanted:
                raise ServerError("DATA_LOSS", f"frame {frame} has {len(data)} bytes and {wanted} should come")
        positions = np.stack([np.frombuffer(frames[frame], "<f4").reshape(-1, 3) for frame in sorted(frames)])
        return Sequence(positions, first.corners, face_sizes=first.face_sizes, fps=Fraction(first.fps),
                        name=first.name)
