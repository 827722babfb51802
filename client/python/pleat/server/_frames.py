"""Poses and frames between arrays and messages. Nothing here speaks to a server."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import Character
from .._pleat import StreamDecoder
from ..v1 import common_pb2, pose_service_pb2
from ._errors import ServerError

COEFFICIENT_STEP_M = np.float32(.0005)  # of packed coefficients
MOST_COEFFICIENTS = 4096

ENCODINGS = {"mesh": pose_service_pb2.FRAME_ENCODING_DRACO_MESH,
             "points": pose_service_pb2.FRAME_ENCODING_DRACO_POINT_CLOUD,
             "delta": pose_service_pb2.FRAME_ENCODING_DRACO_DELTA}
CONTENTS = {"mesh": pose_service_pb2.STREAM_CONTENT_MESH, "control": pose_service_pb2.STREAM_CONTENT_CONTROL_MESH,
            "parameters": pose_service_pb2.STREAM_CONTENT_PARAMETERS}


def pose_message(root_position: npt.NDArray[Any], rotations: npt.NDArray[Any]) -> common_pb2.Pose:
    """3, and J x 4: x, y, z, w."""
    if root_position.shape != (3,) or rotations.ndim != 2 or rotations.shape[1] != 4:
        raise ServerError("INVALID_ARGUMENT", f"a pose has a root position of 3 numbers and rotations of J x 4, not "
                                              f"{root_position.shape} and {rotations.shape}")
    x, y, z = (float(value) for value in root_position)
    return common_pb2.Pose(root_position=common_pb2.Vector3(x=x, y=y, z=z),
                           rotations=[common_pb2.Quaternion(x=q[0], y=q[1], z=q[2], w=q[3])
                                      for q in rotations.tolist()])


def stream_options(content: str, encoding: str, position_bits: int,
                   max_error_mm: float) -> pose_service_pb2.StreamOptions:
    for name, choices in ((content, CONTENTS), (encoding, ENCODINGS)):
        if name not in choices:
            raise ServerError("INVALID_ARGUMENT", f"'{name}' is unknown; choose one of {', '.join(choices)}")
    return pose_service_pb2.StreamOptions(content=CONTENTS[content], encoding=ENCODINGS[encoding],
                                          position_bits=0 if max_error_mm > 0 else position_bits,
                                          max_error_mm=max_error_mm)


def unpack_coefficients(packed: bytes) -> npt.NDArray[np.float32]:
    """Zigzag varints of half a millimeter, deflated. The bytes may come from anywhere."""
    inflater = zlib.decompressobj()
    most = 5 * MOST_COEFFICIENTS
    try:
        data = inflater.decompress(packed, most)
    except zlib.error as error:
        raise ServerError("DATA_LOSS", f"packed coefficients cannot be inflated: {error}") from error
    if not inflater.eof:
        raise ServerError("DATA_LOSS", f"packed coefficients are cut off, or hold more than {MOST_COEFFICIENTS}")
    values, value, shift = [], 0, 0
    for byte in data:
        value |= (byte & 0x7f) << shift
        shift += 7
        if byte < 0x80:
            values.append(((value & 0xffffffff) >> 1) ^ -(value & 1))
            value = shift = 0
        elif shift >= 35:
            raise ServerError("DATA_LOSS", "a packed coefficient is too long")
    if shift:
        raise ServerError("DATA_LOSS", "the last packed coefficient is cut off")
    return np.array(values, np.float32) * COEFFICIENT_STEP_M


def parameters_of(message: pose_service_pb2.FrameParameters) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float32],
                                                                      npt.NDArray[np.float32]]:
    """Root position (3), rotations (J x 4: x, y, z, w) and coefficients, as Character.show takes them for one frame."""
    root = np.array([message.root_position.x, message.root_position.y, message.root_position.z])
    rotations = np.array(message.rotations, np.float32)
    if rotations.size == 0 or rotations.size % 4:
        raise ServerError("DATA_LOSS", f"a frame has {rotations.size} numbers of rotations, not four for each joint")
    if message.packed_coefficients:
        coefficients = unpack_coefficients(message.packed_coefficients)
    else:
        coefficients = np.array(message.coefficients, np.float32)
    return root, rotations.reshape(-1, 4)[:, [1, 2, 3, 0]], coefficients


class FrameReader:
    """Turns the frames of one stream into positions."""

    def __init__(self, header: pose_service_pb2.StreamHeader, character: Character | None) -> None:
        self.num_vertices = header.num_vertices
        self._character, self._decoder = character, None
        if header.content == pose_service_pb2.STREAM_CONTENT_PARAMETERS:
            if character is None:
                raise ServerError("FAILED_PRECONDITION", "a stream of parameters needs the character that shows them: "
                                                         "download it and give it as `character`")
            self.num_vertices = character.num_vertices
            return
        box = header.box
        self._decoder = StreamDecoder(header.encoding, header.num_vertices, header.num_points, header.num_triangles,
                                      (box.origin_x, box.origin_y, box.origin_z), box.range, box.bits,
                                      header.topology_draco, np.array(header.vertex_order, np.int32))

    def positions(self, frame: pose_service_pb2.Frame, bone_scales: npt.ArrayLike = (),
                  out: npt.NDArray[np.float32] | None = None) -> npt.NDArray[np.float32]:
        """V x 3, into `out` when it is given."""
        if self._decoder is not None:
            return self._decoder.decode(frame.draco, frame.difference, frame.checksum, out=out)
        assert self._character is not None
        root, rotations, coefficients = parameters_of(frame.parameters)
        if out is None:
            out = np.empty((self.num_vertices, 3), np.float32)
        self._character.show(root[None], rotations[None], coefficients[None], bone_scales=bone_scales, out=out[None])
        return out
