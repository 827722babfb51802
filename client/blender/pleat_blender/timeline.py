"""The poses of an armature by their frame, from which the history of a query comes. Nothing here knows Blender.

Folds depend on how fast a body moves, so a query shows the pose of a frame and the poses one, two, ... intervals of
the training earlier. Frames may be fractions, and the scene may have another rate than the training: poses between two
known frames are interpolated. What is not known, after a jump on the timeline or before an edit has been played, is
left out, and the oldest known pose then stands for what was before it.
"""

import bisect
import math

import numpy as np

MOST_POSES = 2000
# Known frames that are further apart than this many intervals of the scene say nothing about what lies between.
MOST_GAP = 1.5


def slerp(a, b, fraction):
    """Between two arrays of unit quaternions, J x 4, on the shorter way."""
    dots = np.sum(a * b, axis=1, keepdims=True)
    b = np.where(dots < 0, -b, b)
    angles = np.arccos(np.clip(np.abs(dots), 0, 1))
    sines = np.sin(angles)
    small = sines < 1e-6
    safe = np.where(small, 1, sines)
    first = np.where(small, 1 - fraction, np.sin((1 - fraction) * angles) / safe)
    second = np.where(small, fraction, np.sin(fraction * angles) / safe)
    mixed = first * a + second * b
    return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)


class Timeline:
    def __init__(self, history, frames_per_second):
        """history: poses of a query. frames_per_second: of the training."""
        self.history, self.frames_per_second = history, frames_per_second
        self._frames, self._poses = [], {}

    def clear(self):
        self._frames.clear()
        self._poses.clear()

    def put(self, frame, root, rotations):
        """The pose of a frame as it is now: 3, and J x 4 doubles. Whoever edits a pose leaves the others as known."""
        if frame not in self._poses:
            if len(self._frames) >= MOST_POSES:
                self.clear()
            bisect.insort(self._frames, frame)
        self._poses[frame] = (np.array(root, np.float64), np.array(rotations, np.float64))

    def _at(self, frame, gap):
        """The pose of a time before a known frame, or None where nobody knows it."""
        after = bisect.bisect_left(self._frames, frame - 1e-6)
        if after < len(self._frames) and abs(self._frames[after] - frame) <= 1e-6:
            return self._poses[self._frames[after]]
        if after == 0 or after == len(self._frames):
            return None
        first, second = self._frames[after - 1], self._frames[after]
        if second - first > gap:
            return None
        fraction = (frame - first) / (second - first)
        (root_a, rotations_a), (root_b, rotations_b) = self._poses[first], self._poses[second]
        return root_a + fraction * (root_b - root_a), slerp(rotations_a, rotations_b, fraction)

    def query(self, frame, scene_fps):
        """H x 3 roots and H x J x 4 rotations of a known frame and what is known before it, H from 1 to `history`."""
        interval = scene_fps / self.frames_per_second
        gap = MOST_GAP * max(1.0, interval)
        poses = [self._poses[frame]]
        for h in range(1, self.history):
            pose = self._at(frame - h * interval, gap)
            if pose is None:
                break
            poses.append(pose)
        return (np.ascontiguousarray([root for root, _ in poses]),
                np.ascontiguousarray([rotations for _, rotations in poses]))

    def lead(self, scene_fps):
        """How many frames before the first one must be known for a full history."""
        return math.ceil((self.history - 1) * scene_fps / self.frames_per_second)
