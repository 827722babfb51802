"""Pleat's axes have Y up, Blender's Z: (x, y, z) there is (x, -z, y) here. Nothing here knows Blender."""

import numpy as np


def to_blender(positions):
    """... x 3, a new array of the same type."""
    return np.stack([positions[..., 0], -positions[..., 2], positions[..., 1]], axis=-1)


def from_blender(positions):
    return np.stack([positions[..., 0], positions[..., 2], -positions[..., 1]], axis=-1)


def rotation_from_blender(w, x, y, z):
    """A quaternion as Blender writes it -> x, y, z, w about Pleat's axes."""
    return x, z, -y, w


def rotation_to_blender(x, y, z, w):
    """The way back -> w, x, y, z."""
    return w, x, -z, y
