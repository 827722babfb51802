"""What an object shows over time, as a take: a mesh cache, Alembic, shape keys, a simulated cloth, any modifier."""

from fractions import Fraction

import numpy as np

from . import axes
from .library import PleatError


def frame_rate(scene):
    """Frames per second as a fraction: 24000/1001 stays what it is."""
    return Fraction(scene.render.fps) / Fraction(scene.render.fps_base).limit_denominator(1001)


class Recording:
    """Plays the scene and copies the mesh of every frame. `step` takes one frame, so that the interface goes on."""

    def __init__(self, context, mesh_object, first, last):
        if mesh_object is None or mesh_object.type != "MESH":
            raise PleatError("INVALID_ARGUMENT", "select the mesh that moves")
        if last <= first:
            raise PleatError("INVALID_ARGUMENT", f"frames {first} to {last} are no animation: set the scene's range")
        self._context, self._object = context, mesh_object
        self._frames, self._before = list(range(first, last + 1)), context.scene.frame_current
        self._positions, self.face_sizes, self.corners = None, None, None
        self._taken = 0

    @property
    def fraction(self):
        return self._taken / len(self._frames)

    def step(self):
        """Returns False when all frames are there."""
        if self._taken == len(self._frames):
            return False
        frame = self._frames[self._taken]
        self._context.scene.frame_set(frame)
        shown = self._object.evaluated_get(self._context.evaluated_depsgraph_get())
        mesh = shown.to_mesh()
        try:
            self._copy(mesh, shown.matrix_world, frame)
        finally:
            shown.to_mesh_clear()
        self._taken += 1
        return self._taken < len(self._frames)

    def _copy(self, mesh, matrix_world, frame):
        positions = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", positions)
        if self._positions is None:
            self._take_faces(mesh)
            self._positions = np.empty((len(self._frames), len(mesh.vertices), 3), np.float32)
        if len(mesh.vertices) != self._positions.shape[1]:
            raise PleatError("INVALID_ARGUMENT", f"'{self._object.name}' has {len(mesh.vertices)} vertices in frame "
                                                 f"{frame} and {self._positions.shape[1]} before: a take keeps its "
                                                 "vertices; switch modifiers off that make new ones")
        world = np.array(matrix_world, np.float64)
        placed = positions.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]
        self._positions[self._taken] = axes.from_blender(placed)

    def _take_faces(self, mesh):
        self.face_sizes = np.empty(len(mesh.polygons), np.int32)
        mesh.polygons.foreach_get("loop_total", self.face_sizes)
        self.corners = np.empty(len(mesh.loops), np.int32)
        mesh.loops.foreach_get("vertex_index", self.corners)

    def finish(self):
        """Puts the timeline back and returns positions (T x V x 3, Y up), sizes and corners of the faces."""
        self._context.scene.frame_set(self._before)
        return self._positions, self.face_sizes, self.corners
