"""Characters and their frames in this process. Arrays have the shapes that are named; positions are meters, Y up.

Shapes: V vertices, J joints, H poses of one query, the newest first. Nothing here knows Blender.
"""

import ctypes
from ctypes import byref, c_double, c_size_t, c_uint32, c_void_p

import numpy as np

from .library import SKINNED_ONLY, ModelInfo, ModelRecord, Pose, Query, Rows, evaluating

MOST_INFLUENCES = 8


def poses_of(roots, rotations):
    """The poses of one query for a call: H x 3 and H x J x 4 doubles, which must outlive it."""
    poses = (Pose * len(roots))()
    for h, pose in enumerate(poses):
        pose.root_position[:] = roots[h]
        pose.rotations = rotations[h].ctypes.data
        pose.num_joints = rotations.shape[1]
    return poses


def rows_of(array):
    """A contiguous V x 3 float32 array as the place where positions are written."""
    assert array.dtype == np.float32 and array.flags.c_contiguous
    return Rows(array.ctypes.data, 0, array.nbytes)


class Character:
    """A model from the bytes of a .pleat file. It never changes; threads share it, each with its own Evaluator."""

    def __init__(self, data):
        self.library = evaluating()
        self.handle = c_void_p()
        self.library.call("pleat_model_create", data, c_size_t(len(data)), None, byref(self.handle))
        info = ModelInfo()
        self.library.call("pleat_model_get_info", self.handle, byref(info))
        self.num_vertices, self.num_joints, self.history = info.num_vertices, info.num_joints, info.history
        self.frames_per_second = info.frames_per_second
        self.name = self.library.text("pleat_model_name", self.handle)
        joints = range(self.num_joints)
        self.joint_names = [self.library.text("pleat_model_joint_name", self.handle, c_uint32(j)) for j in joints]
        self.parents = [self.library.value("pleat_model_joint_parent", self.handle, c_uint32(j)) for j in joints]
        self.joint_positions = self._copy("joints", np.float64, 3 * info.num_joints).reshape(-1, 3)
        self.rest_positions = self._copy("rest_positions", np.float32, 3 * info.num_vertices).reshape(-1, 3)
        self.face_sizes = self._copy("face_sizes", np.uint32, info.num_faces)
        self.corners = self._copy("corners", np.uint32, info.num_corners)
        self.texcoords = self._copy("texcoords", np.float32, 2 * info.num_texcoords).reshape(-1, 2)
        self.corner_texcoords = (self._copy("corner_texcoords", np.int32, info.num_corners)
                                 if info.num_texcoords else np.empty(0, np.int32))
        self._read_record()

    def __del__(self):
        if getattr(self, "handle", None):
            self.library.value("pleat_model_destroy", self.handle)

    def _copy(self, name, kind, count):
        values = np.empty(count, kind)
        self.library.call(f"pleat_model_copy_{name}", self.handle, c_void_p(values.ctypes.data), c_size_t(count))
        return values

    def _read_record(self):
        record = ModelRecord()
        self.library.call("pleat_model_get_record", self.handle, byref(record))
        self.learner = record.learner.decode("utf-8", "replace")
        self.num_training_frames = record.num_frames
        self.skinned_mean_percent, self.skinned_mean_mm = record.skinned.mean_percent, record.skinned.mean_mm
        self.detailed_mean_percent, self.detailed_mean_mm = record.detailed.mean_percent, record.detailed.mean_mm
        self.warnings = [self.library.text("pleat_model_warning", self.handle, c_uint32(w))
                         for w in range(record.num_warnings)]

    def influences(self):
        """V x 8 bones and weights, the strongest first. Bone b ends in joint b."""
        shape = (self.num_vertices, MOST_INFLUENCES)
        bones, weights = np.empty(shape, np.uint32), np.empty(shape, np.float32)
        self.library.call("pleat_model_copy_influences", self.handle, c_uint32(MOST_INFLUENCES),
                          c_void_p(bones.ctypes.data), c_void_p(weights.ctypes.data), c_size_t(bones.size))
        return bones, weights

    def joint_confidence(self, roots, rotations):
        """J numbers: 1 where the training has a joint as it is now, 0 where it never was so."""
        found = np.empty(self.num_joints, np.float64)
        poses = poses_of(roots, rotations)
        self.library.call("pleat_joint_confidence", self.handle, poses, c_size_t(len(poses)),
                          found.ctypes.data_as(ctypes.POINTER(c_double)), c_size_t(self.num_joints))
        return found


class Evaluator:
    """Turns poses into positions; for one thread at a time."""

    def __init__(self, character):
        self.character = character
        self.handle = c_void_p()
        character.library.call("pleat_evaluator_create", character.handle, byref(self.handle))
        self._skinned = None

    def __del__(self):
        if getattr(self, "handle", None):
            self.character.library.value("pleat_evaluator_destroy", self.handle)

    def evaluate(self, roots, rotations, out, strength=1.0):
        """Writes V x 3 positions into `out` and returns the confidence.

        strength: of the learned detail; 0 is skinning alone, above 1 exaggerates the folds.
        """
        poses = poses_of(roots, rotations)
        if strength == 1:
            return self._answer(poses, [(out, 0)])
        if strength == 0:
            return self._answer(poses, [(out, SKINNED_ONLY)])
        if self._skinned is None:
            self._skinned = np.empty((self.character.num_vertices, 3), np.float32)
        confidence = self._answer(poses, [(out, 0), (self._skinned, SKINNED_ONLY)])
        blend(self._skinned, out, strength)
        return confidence

    def _answer(self, poses, frames):
        queries = (Query * len(frames))()
        for query, (out, flags) in zip(queries, frames):
            query.struct_size = ctypes.sizeof(Query)
            query.poses, query.num_poses, query.flags = poses, len(poses), flags
            query.positions = rows_of(out)
        self.character.library.call("pleat_evaluate", self.handle, queries, c_size_t(len(queries)))
        return queries[0].confidence


def blend(skinned, detailed, strength):
    """Moves `detailed` towards `skinned` or beyond it, in place: strength 0 is `skinned`, 1 leaves it."""
    detailed -= skinned
    detailed *= np.float32(strength)
    detailed += skinned
