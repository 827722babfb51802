"""The C libraries of Pleat by ctypes, with the structs of pleat.h, pleat_session.h and pleat_server.h.

libpleat_eval evaluates characters in this process. libpleat has servers and takes besides, and needs gRPC on this
machine; where it does not load, everything else still works. Nothing here knows Blender.
"""

import ctypes
import functools
import os
import pathlib
import sys
from ctypes import c_char, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

API_VERSION = 1
FOLDER = pathlib.Path(__file__).parent / "lib"
CODES = {1: "CANCELLED", 2: "UNKNOWN", 3: "INVALID_ARGUMENT", 4: "DEADLINE_EXCEEDED", 5: "NOT_FOUND",
         6: "ALREADY_EXISTS", 7: "PERMISSION_DENIED", 8: "RESOURCE_EXHAUSTED", 9: "FAILED_PRECONDITION", 10: "ABORTED",
         11: "OUT_OF_RANGE", 12: "UNIMPLEMENTED", 13: "INTERNAL", 14: "UNAVAILABLE", 15: "DATA_LOSS",
         16: "UNAUTHENTICATED"}


class PleatError(Exception):
    """What went wrong, where, and what to do. `code` is the name of a status."""

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


class Error(ctypes.Structure):
    _fields_ = [("code", c_int32), ("message", c_char * 1020)]


class Sized(ctypes.Structure):
    """A struct that begins with its size, which is filled in."""

    def __init__(self, **fields):
        super().__init__(struct_size=ctypes.sizeof(type(self)), **fields)


class ModelInfo(Sized):
    _fields_ = [("struct_size", c_size_t)] + [(name, c_uint32) for name in (
        "num_vertices", "num_faces", "num_corners", "num_triangles", "num_texcoords", "num_joints",
        "num_coefficients", "history")] + [("frames_per_second", c_double), ("memory_bytes", c_uint64)]


class Errors(ctypes.Structure):
    _fields_ = [(name, c_double) for name in ("mean_percent", "rms_percent", "p95_percent", "max_percent", "mean_mm")]


class ModelRecord(Sized):
    _fields_ = [("struct_size", c_size_t), ("learner", c_char_p), ("num_frames", c_uint32),
                ("num_warnings", c_uint32), ("rig_residual", c_double), ("diagonal_m", c_double),
                ("skinned", Errors), ("detailed", Errors)]


class Pose(ctypes.Structure):
    _fields_ = [("root_position", c_double * 3), ("rotations", c_void_p), ("num_joints", c_size_t)]


class Rows(ctypes.Structure):
    _fields_ = [("data", c_void_p), ("stride", c_size_t), ("num_bytes", c_size_t)]


class Query(Sized):
    _fields_ = [("struct_size", c_size_t), ("poses", ctypes.POINTER(Pose)), ("num_poses", c_size_t),
                ("bone_scales", c_void_p), ("positions", Rows), ("normals", Rows), ("confidence", c_double),
                ("code", c_int32), ("flags", c_uint32)]


SKINNED_ONLY = 1


class SessionOptions(Sized):
    _fields_ = [("struct_size", c_size_t), ("address", c_char_p), ("model_id", c_char_p), ("token", c_char_p),
                ("tls_root_certificates", c_char_p), ("connect_seconds", c_double), ("bone_scales", c_void_p),
                ("num_bone_scales", c_size_t)] + [(name, c_uint32) for name in (
                    "content", "position_bits", "max_in_flight", "latest_wins", "skinned_only", "max_reconnects")]


class Frame(Sized):
    _fields_ = [("struct_size", c_size_t), ("positions", Rows), ("number", c_uint64), ("confidence", c_double)] + [
        (name, c_uint32) for name in ("num_superseded", "resumed", "queue_us", "evaluate_us", "encode_us")]


class ServerOptions(Sized):
    _fields_ = [("struct_size", c_size_t), ("address", c_char_p), ("token", c_char_p),
                ("tls_root_certificates", c_char_p), ("connect_seconds", c_double)]


class TakeMesh(Sized):
    _fields_ = [("struct_size", c_size_t), ("name", c_char_p), ("num_vertices", c_uint32), ("num_frames", c_uint32),
                ("face_sizes", c_void_p), ("num_faces", c_size_t), ("corners", c_void_p), ("num_corners", c_size_t),
                ("rate_numerator", c_int32), ("rate_denominator", c_int32)]


class TakeInfo(Sized):
    _fields_ = [("struct_size", c_size_t), ("num_vertices", c_uint32), ("num_faces", c_uint32),
                ("num_frames", c_uint32), ("rate_numerator", c_int32), ("rate_denominator", c_int32),
                ("num_notes", c_uint32)]


ID_SIZE = 65


class Training(Sized):
    _fields_ = [("struct_size", c_size_t), ("sequence_ids", ctypes.POINTER(c_char_p)), ("num_sequences", c_size_t),
                ("name", c_char_p), ("options", c_char_p)]


class Job(Sized):
    _fields_ = [("struct_size", c_size_t), ("state", c_uint32), ("stage", c_char * 64), ("fraction", c_double),
                ("eta_seconds", c_double), ("result_id", c_char * ID_SIZE)]


class ModelEntry(Sized):
    _fields_ = [("struct_size", c_size_t), ("id", c_char_p), ("name", c_char_p), ("learner", c_char_p),
                ("num_vertices", c_uint32), ("num_joints", c_uint32), ("frames_per_second", c_double),
                ("size_bytes", c_uint64)]


PROGRESS = ctypes.CFUNCTYPE(c_int, c_void_p, c_char_p, c_double)
JOB_OBSERVER = ctypes.CFUNCTYPE(c_int, c_void_p, ctypes.POINTER(Job))
MODEL_VISITOR = ctypes.CFUNCTYPE(c_int, c_void_p, ctypes.POINTER(ModelEntry))
BYTES_TAKER = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)

# Results of functions that are no code, and arguments that ctypes would pass with the wrong width.
RESULTS = {"pleat_version": c_char_p, "pleat_api_version": c_uint32, "pleat_model_name": c_char_p,
           "pleat_model_joint_name": c_char_p, "pleat_model_joint_parent": c_int32, "pleat_model_warning": c_char_p,
           "pleat_session_num_vertices": c_uint32, "pleat_session_ended": c_int, "pleat_take_name": c_char_p,
           "pleat_take_note": c_char_p}
FLOATS, DOUBLES = ctypes.POINTER(c_float), ctypes.POINTER(c_double)


class Library:
    """One of the two libraries. A call lets other threads of Python run."""

    def __init__(self, path):
        try:
            self._functions = ctypes.CDLL(os.fspath(path))
        except OSError as error:
            raise PleatError("FAILED_PRECONDITION", f"{path} does not load: {error}") from error
        for name, result in RESULTS.items():
            if hasattr(self._functions, name):
                getattr(self._functions, name).restype = result
        version = self._functions.pleat_api_version()
        if version != API_VERSION:
            raise PleatError("UNIMPLEMENTED", f"{path} has version {version} of the C interface and this add-on needs "
                                              f"{API_VERSION}; install the add-on and the library of one release")

    def call(self, name, *arguments):
        """Calls a function whose last argument is the error, which is raised."""
        error = Error()
        code = getattr(self._functions, name)(*arguments, ctypes.byref(error))
        if code != 0:
            raise PleatError(CODES.get(code, str(code)), error.message.decode("utf-8", "replace"))

    def value(self, name, *arguments):
        """Calls a function that cannot fail."""
        return getattr(self._functions, name)(*arguments)

    def text(self, name, *arguments):
        found = self.value(name, *arguments)
        return None if found is None else found.decode("utf-8", "replace")

    @property
    def version(self):
        return self.text("pleat_version")


def file_name(stem):
    endings = {"darwin": f"lib{stem}.dylib", "win32": f"{stem}.dll"}
    return endings.get(sys.platform, f"lib{stem}.so")


@functools.cache
def evaluating():
    """libpleat_eval, which is part of the add-on."""
    return Library(FOLDER / file_name("pleat_eval"))


@functools.cache
def serving():
    """libpleat. Where it is missing or gRPC is, the error says what to install."""
    try:
        return Library(FOLDER / file_name("pleat"))
    except PleatError as error:
        if error.code != "FAILED_PRECONDITION":
            raise
        raise PleatError(error.code, f"servers cannot be reached from here, characters in this process can: {error}; "
                                     "on Debian 12 and its kin install libgrpc++1.51 and libdraco7") from error
