"""Confidence as colors: blue is like the training, red is unknown. Nothing here knows Blender."""

import numpy as np

ATTRIBUTE = "Pleat confidence"
# Linear colors at confidence 0, 1/2 and 1, which people with any vision of colors tell apart.
SCALE = np.array([[.66, .03, .02, 1], [1, .83, .24, 1], [.04, .18, .46, 1]], np.float32)


def vertex_weights(influences, num_joints):
    """V x J float32: how much of a vertex's confidence each joint is. influences: bones and weights, V x 8."""
    bones, weights = influences
    dense = np.zeros((bones.shape[0], num_joints), np.float32)
    rows = np.repeat(np.arange(bones.shape[0]), bones.shape[1])
    np.add.at(dense, (rows, bones.ravel()), weights.ravel())
    return dense


def colors(confidence):
    """V numbers from 0 to 1 -> V x 4 linear colors."""
    place = np.clip(confidence, 0, 1).astype(np.float32) * (len(SCALE) - 1)
    lower = np.minimum(place.astype(np.int32), len(SCALE) - 2)
    fraction = (place - lower)[:, None]
    return (1 - fraction) * SCALE[lower] + fraction * SCALE[lower + 1]
