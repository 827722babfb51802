"""The detailed mesh of a range of frames, as shape keys or files that are shown without Pleat."""

import pathlib
import struct

import bpy
import numpy as np

from . import armature, axes, live, models
from .character import Evaluator
from .library import PleatError
from .recording import frame_rate
from .service import Take
from .timeline import Timeline


class Bake:
    """Evaluates frame by frame in this process; `step` takes one frame, so that the interface goes on."""

    def __init__(self, context, rig, first, last):
        if last < first:
            raise PleatError("INVALID_ARGUMENT", f"frames {first} to {last} are none: set the scene's range")
        self.context, self.rig = context, rig
        self.character = models.load(rig.pleat)
        self.first, self.fps = first, frame_rate(context.scene)
        self._timeline = Timeline(self.character.history, self.character.frames_per_second)
        self._evaluator = Evaluator(self.character)
        lead = self._timeline.lead(float(self.fps))  # the history of the first frame
        self._frames, self._done = list(range(first - lead, last + 1)), 0
        self._before = context.scene.frame_current
        self.positions = np.empty((last + 1 - first, self.character.num_vertices, 3), np.float32)  # Y up

    @property
    def fraction(self):
        return self._done / len(self._frames)

    def step(self):
        """Returns False when all frames are there."""
        if self._done == len(self._frames):
            return False
        frame = self._frames[self._done]
        self.context.scene.frame_set(frame)
        rig = self.rig.evaluated_get(self.context.evaluated_depsgraph_get())
        self._timeline.put(frame, *armature.read_pose(rig, self.character))
        if frame >= self.first:
            roots, rotations = self._timeline.query(frame, float(self.fps))
            self._evaluator.evaluate(roots, rotations, self.positions[frame - self.first], self.rig.pleat.strength)
        self._done += 1
        return self._done < len(self._frames)

    def restore(self):
        self.context.scene.frame_set(self._before)
        live.refresh(self.rig)


def _copy_of_mesh(bake, suffix):
    """A mesh object of its own, where the character's mesh is, without modifiers and groups."""
    source = bake.rig.pleat.mesh
    if source is None:
        raise PleatError("FAILED_PRECONDITION", f"'{bake.rig.name}' has lost its mesh")
    baked = bpy.data.objects.new(f"{bake.rig.name} {suffix}", source.data.copy())
    bake.context.collection.objects.link(baked)
    baked.parent = bake.rig
    armature.show_positions(baked, axes.to_blender(bake.positions[0]))
    return baked


def to_shape_keys(bake):
    """One key for each frame, which is 1 in its frame and 0 in all others."""
    baked = _copy_of_mesh(bake, "shape keys")
    baked.shape_key_add(name="Basis", from_mix=False)
    preferences = bpy.context.preferences.edit
    before = preferences.keyframe_new_interpolation_type
    preferences.keyframe_new_interpolation_type = "LINEAR"
    try:
        for t, positions in enumerate(bake.positions):
            frame = bake.first + t
            key = baked.shape_key_add(name=f"frame {frame}", from_mix=False)
            key.data.foreach_set("co", axes.to_blender(positions).ravel())
            for value, at in ((0, frame - 1), (1, frame), (0, frame + 1)):
                key.value = value
                key.keyframe_insert("value", frame=at)
    finally:
        preferences.keyframe_new_interpolation_type = before
    baked.data.update()
    return baked


def write_pc2(path, positions, first_frame):
    """A point cache as other programs read it: T x V x 3 float32."""
    header = struct.pack("<12siiffi", b"POINTCACHE2\0", 1, positions.shape[1], float(first_frame), 1.0,
                         positions.shape[0])
    pathlib.Path(path).write_bytes(header + np.ascontiguousarray(positions, "<f4").tobytes())


def to_point_cache(bake, path):
    """A .pc2 with Y up, and a mesh that plays it with the Mesh Cache modifier."""
    write_pc2(path, bake.positions, bake.first)
    baked = _copy_of_mesh(bake, "point cache")
    modifier = baked.modifiers.new("Mesh Cache", "MESH_CACHE")
    modifier.cache_format = "PC2"
    modifier.filepath = str(path)
    modifier.forward_axis, modifier.up_axis = "POS_Z", "NEG_Y"  # what turns Y up into Z up there
    modifier.frame_start = bake.first
    return baked


def to_alembic(bake, path):
    """An archive that every package reads; Blender's own writer is not needed."""
    character = bake.character
    take = Take.of_arrays(bake.positions, character.face_sizes, character.corners, bake.fps, bake.rig.name)
    take.write(path)
