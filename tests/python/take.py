"""One small performer and a character that was trained on it, shared by the tests of this folder."""

import functools

import numpy as np
import pleat


@functools.cache
def performer():
    return pleat.performer(40, 700, seed=3)


@functools.cache
def character():
    return pleat.train(performer(), learner="gp")


@functools.cache
def motion():
    return character().fit(performer())


def queries(frames):
    """Root positions and rotations of these frames with the pose before each as history."""
    frames = np.asarray(frames)
    order = np.stack([frames, frames - 1], axis=1)
    return motion().root_positions[order], motion().rotations[order]
