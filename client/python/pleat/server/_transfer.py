"""Uploads and downloads that go on where they stopped."""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any

import grpc

from .. import ProgressFunction
from ..v1 import sequence_service_pb2
from ._errors import ServerError, translated

CHUNK_BYTES = 512 << 10
ATTEMPTS = 5
TRANSIENT = (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.ABORTED)


async def again(attempt: Callable[[], Awaitable[Any]], address: str) -> Any:
    """Makes a call up to five times while what goes wrong may pass, with growing pauses."""
    for number in range(ATTEMPTS):
        try:
            return await attempt()
        except grpc.RpcError as error:
            if error.code() not in TRANSIENT or number + 1 == ATTEMPTS:
                with translated(address):
                    raise
        await asyncio.sleep(.1 * 2 ** number)
    raise AssertionError("not reached")


async def upload(stub: Any, sequences: Any, data: bytes, metadata: Any, address: str, ttl_seconds: int,
                 progress: ProgressFunction | None) -> Any:
    """Sends a file by `stub`, an Upload... method, and returns its response. sequences: the stub that knows how far."""
    content_id = hashlib.sha256(data).hexdigest()
    header = sequence_service_pb2.UploadSequenceRequest.Header

    async def attempt() -> Any:
        known = await sequences.QueryUpload(sequence_service_pb2.QueryUploadRequest(id=content_id), metadata=metadata)
        start = 0 if known.complete else known.received_bytes

        async def parts() -> AsyncIterator[Any]:
            yield sequence_service_pb2.UploadSequenceRequest(header=header(
                id=content_id, size_bytes=len(data), offset_bytes=start, ttl_seconds=ttl_seconds))
            if known.complete:
                return
            for offset in range(start, len(data), CHUNK_BYTES):
                yield sequence_service_pb2.UploadSequenceRequest(data=data[offset:offset + CHUNK_BYTES])
                if progress:
                    progress("upload", min(1.0, (offset + CHUNK_BYTES) / len(data)))
        return await stub(parts(), metadata=metadata)
    response = await again(attempt, address)
    if progress:
        progress("upload", 1.0)
    return response


async def download(method: Any, make_request: Callable[[int], Any], metadata: Any, address: str, content_id: str,
                   progress: ProgressFunction | None) -> bytes:
    """Reads a file in chunks and checks it against its id. make_request: of the offset to go on from."""
    data = bytearray()

    async def attempt() -> None:
        async for part in method(make_request(len(data)), metadata=metadata):
            if part.offset_bytes != len(data):
                raise ServerError("DATA_LOSS", f"the server at '{address}' sent byte {part.offset_bytes} of the file "
                                               f"and {len(data)} should come")
            data.extend(part.data)
            if progress and part.size_bytes:
                progress("download", len(data) / part.size_bytes)
    await again(attempt, address)
    if hashlib.sha256(data).hexdigest() != content_id:
        raise ServerError("DATA_LOSS", f"what the server at '{address}' sent is not the file {content_id[:12]}...; "
                                       "download it again")
    return bytes(data)
