"""Live sessions: poses go out, frames come back in the same order (docs/live_sessions.md)."""

from __future__ import annotations

import asyncio
import dataclasses
from collections.abc import AsyncIterator
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import Character
from ..v1 import pose_service_pb2
from ._errors import ServerError, translated
from ._frames import FrameReader, pose_message


@dataclasses.dataclass(frozen=True)
class LiveFrame:
    """The answer to one pose."""

    number: int  # of the pose
    positions: npt.NDArray[np.float32]  # V x 3, meters
    confidence: float
    num_superseded: int  # poses before this one that get no frame
    queue_us: int
    evaluate_us: int
    encode_us: int


class LiveSession:
    """Made by Server.session, as `async with`. One task may send while another receives."""

    def __init__(self, address: str, call: Any, start: pose_service_pb2.LiveSessionRequest.Start,
                 character: Character | None) -> None:
        self._address, self._call, self._start, self._character = address, call, start, character
        self._reader: FrameReader | None = None
        self._writing = asyncio.Lock()  # gRPC takes one message at a time
        self._received = 0

    async def __aenter__(self) -> LiveSession:
        with translated(self._address):
            await self._write(pose_service_pb2.LiveSessionRequest(start=self._start))
            response = await self._read()
        if response is None or response.WhichOneof("part") != "header":
            raise ServerError("DATA_LOSS", f"the session with '{self._address}' does not begin with a header")
        self._reader = FrameReader(response.header, self._character)
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None,
                        trace: TracebackType | None) -> None:
        self._call.cancel()

    @property
    def num_vertices(self) -> int:
        assert self._reader is not None
        return self._reader.num_vertices

    async def send(self, number: int, root_position: npt.ArrayLike, rotations: npt.ArrayLike, *,
                   restart: bool = False, keyframe: bool = False) -> None:
        """Sends a pose: 3 and J x 4, or H x 3 and H x J x 4 with the poses before it. `number` comes back.

        restart: forgets the poses sent before (a cut). keyframe: asks for a frame that is no difference, after an
        error DATA_LOSS. Waits while the server takes no more.
        """
        roots, all_rotations = np.asarray(root_position, np.float64), np.asarray(rotations, np.float64)
        if roots.ndim == 1:
            roots, all_rotations = roots[None], all_rotations[None]
        if not len(roots) or len(roots) != len(all_rotations):
            raise ServerError("INVALID_ARGUMENT", f"{len(roots)} root positions and {len(all_rotations)} rotations are "
                                                  "not the poses of one query")
        poses = [pose_message(root, turned) for root, turned in zip(roots, all_rotations, strict=True)]
        pose = pose_service_pb2.LiveSessionRequest.LivePose(
            number=number, pose=poses[0], history=poses[1:], restart=restart, keyframe=keyframe,
            frames_received=self._received)
        with translated(self._address):
            await self._write(pose_service_pb2.LiveSessionRequest(pose=pose))

    async def receive(self, *, out: npt.NDArray[np.float32] | None = None) -> LiveFrame | None:
        """The next frame, or None at the end. A pose that cannot be shown raises its reason; the session goes on."""
        with translated(self._address):
            response = await self._read()
        if response is None:
            return None
        self._received += 1
        if self._start.latest_wins:  # the server waits for it before it sends more
            with translated(self._address):
                await self._write(pose_service_pb2.LiveSessionRequest(
                    acknowledgement=pose_service_pb2.LiveSessionRequest.Acknowledgement(
                        frames_received=self._received)))
        if response.WhichOneof("part") == "rejection":
            import grpc
            names = {code.value[0]: code.name for code in grpc.StatusCode}
            rejection = response.rejection
            raise ServerError(names.get(rejection.code, "UNKNOWN"), f"pose {rejection.number}: {rejection.message}")
        assert self._reader is not None
        frame, report = response.frame, response.report
        positions = self._reader.positions(frame, list(self._start.character.bone_scales), out)
        return LiveFrame(frame.number, positions, frame.confidence, report.num_superseded, report.queue_us,
                         report.evaluate_us, report.encode_us)

    async def done(self) -> None:
        """Says that no pose will follow; `receive` gives the frames that are still to come, then None."""
        with translated(self._address):
            await self._call.done_writing()

    async def __aiter__(self) -> AsyncIterator[LiveFrame]:
        while (frame := await self.receive()) is not None:
            yield frame

    async def _write(self, request: pose_service_pb2.LiveSessionRequest) -> None:
        async with self._writing:
            try:
                await self._call.write(request)
            except asyncio.InvalidStateError:  # it has ended: its status says why
                await self._raise_status()
                raise ServerError("UNAVAILABLE", f"the session with '{self._address}' has ended") from None

    async def _read(self) -> pose_service_pb2.LiveSessionResponse | None:
        import grpc.aio
        response = await self._call.read()
        if response is grpc.aio.EOF:
            await self._raise_status()
            return None
        return response  # type: ignore[no-any-return]

    async def _raise_status(self) -> None:
        import grpc
        code = await self._call.code()
        if code != grpc.StatusCode.OK:
            with translated(self._address):
                raise grpc.aio.AioRpcError(code, await self._call.initial_metadata(),
                                           await self._call.trailing_metadata(), await self._call.details())
