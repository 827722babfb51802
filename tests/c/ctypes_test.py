"""Loads libpleat_eval with ctypes, as a script that has no package for it would, and compares its frames
with our own (write_character.cpp).

usage: ctypes_test.py LIBRARY FOLDER
"""

import array
import ctypes
import pathlib
import sys
import threading

SIZE = ctypes.c_size_t


class Error(ctypes.Structure):
    _fields_ = [("code", ctypes.c_int32), ("message", ctypes.c_char * 1020)]


class ModelInfo(ctypes.Structure):
    _fields_ = [("struct_size", SIZE)] + [(name, ctypes.c_uint32) for name in (
        "num_vertices", "num_faces", "num_corners", "num_triangles", "num_texcoords", "num_joints",
        "num_coefficients", "history")] + [("frames_per_second", ctypes.c_double), ("memory_bytes", ctypes.c_uint64)]


class Pose(ctypes.Structure):
    _fields_ = [("root_position", ctypes.c_double * 3), ("rotations", ctypes.POINTER(ctypes.c_double)),
                ("num_joints", SIZE)]


class Rows(ctypes.Structure):
    _fields_ = [("data", ctypes.c_void_p), ("stride", SIZE), ("num_bytes", SIZE)]


class Query(ctypes.Structure):
    _fields_ = [("struct_size", SIZE), ("poses", ctypes.POINTER(Pose)), ("num_poses", SIZE),
                ("bone_scales", ctypes.c_void_p), ("positions", Rows), ("normals", Rows),
                ("confidence", ctypes.c_double), ("code", ctypes.c_int32), ("flags", ctypes.c_uint32)]


class Library:
    """Calls functions of the library and raises what they report."""

    def __init__(self, path):
        self.functions = ctypes.CDLL(path)

    def call(self, name, *arguments):
        error = Error()
        if getattr(self.functions, name)(*arguments, ctypes.byref(error)) != 0:
            raise RuntimeError(f"{name}: code {error.code}: {error.message.decode()}")


def read_values(path, kind):
    values = array.array(kind)
    values.frombytes(path.read_bytes())
    return values


class Character:
    def __init__(self, library, folder):
        self.library = library
        model_bytes = (folder / "character.pleat").read_bytes()
        self.model = ctypes.c_void_p()
        library.call("pleat_model_create", model_bytes, SIZE(len(model_bytes)), None, ctypes.byref(self.model))
        self.info = ModelInfo(struct_size=ctypes.sizeof(ModelInfo))
        library.call("pleat_model_get_info", self.model, ctypes.byref(self.info))
        self.values = read_values(folder / "poses.f64", "d")
        self.expected = (folder / "frames.f32").read_bytes()
        self.confidence = read_values(folder / "confidence.f64", "d")
        self.num_frames = len(self.confidence)

    def pose(self, t):
        width = 3 + 4 * self.info.num_joints
        values = self.values[t * width:(t + 1) * width]
        rotations = (ctypes.c_double * (width - 3))(*values[3:])
        return Pose((ctypes.c_double * 3)(*values[:3]), rotations, self.info.num_joints)

    def check_all_frames(self):
        """One batch of all frames, compared byte by byte."""
        evaluator = ctypes.c_void_p()
        self.library.call("pleat_evaluator_create", self.model, ctypes.byref(evaluator))
        frame_bytes = 12 * self.info.num_vertices
        buffer = ctypes.create_string_buffer(frame_bytes * self.num_frames)
        queries = (Query * self.num_frames)()
        for t, query in enumerate(queries):
            history = [self.pose(t)] + ([self.pose(t - 1)] if t else [])
            query.struct_size = ctypes.sizeof(Query)
            query.poses = (Pose * len(history))(*history)
            query.num_poses = len(history)
            query.positions = Rows(ctypes.addressof(buffer) + t * frame_bytes, 0, frame_bytes)
        self.library.call("pleat_evaluate", evaluator, queries, SIZE(self.num_frames))
        assert buffer.raw == self.expected, "a frame differs from our own"
        assert [query.confidence for query in queries] == list(self.confidence)
        self.library.functions.pleat_evaluator_destroy(evaluator)


def check_errors(library):
    model = ctypes.c_void_p()
    for damaged in (b"", b"no model", b"PLEATMDL" + bytes(1000)):
        try:
            library.call("pleat_model_create", damaged, SIZE(len(damaged)), None, ctypes.byref(model))
        except RuntimeError as error:
            assert len(str(error)) > 40, error
        else:
            raise AssertionError("damaged bytes became a model")
        assert not model


def main():
    library, folder = Library(sys.argv[1]), pathlib.Path(sys.argv[2])
    library.functions.pleat_version.restype = ctypes.c_char_p
    print("libpleat_eval", library.functions.pleat_version().decode())
    assert library.functions.pleat_api_version() == 1
    character = Character(library, folder)
    failures = []

    def check():
        try:
            character.check_all_frames()
        except Exception as error:  # noqa: BLE001: it is reported below
            failures.append(error)

    # ctypes lets other threads run during a call.
    threads = [threading.Thread(target=check) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures, failures
    check_errors(library)
    print(f"{character.num_frames} frames of {character.info.num_vertices} vertices are equal to our own")


if __name__ == "__main__":
    main()
