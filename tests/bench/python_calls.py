"""The Python package against the C library in one process: what Python adds to a batch of queries.

usage: PYTHONPATH=build/python:tests/c python3 tests/bench/python_calls.py build/client/c/libpleat_eval.so
"""

import ctypes
import statistics
import sys
import time

import numpy as np
import pleat
from ctypes_test import SIZE, Library, Pose, Query, Rows

NUM_VERTICES, NUM_FRAMES, BATCH, NUM_PAIRS = 10_000, 40, 16, 100


class CBatch:
    """The same queries through the C interface."""

    def __init__(self, path, character, roots, rotations):
        self.library = Library(path)
        model_bytes = character.to_bytes()
        model, self.evaluator = ctypes.c_void_p(), ctypes.c_void_p()
        self.library.call("pleat_model_create", model_bytes, SIZE(len(model_bytes)), None, ctypes.byref(model))
        self.library.call("pleat_evaluator_create", model, ctypes.byref(self.evaluator))
        self.positions = np.empty((BATCH, character.num_vertices, 3), np.float32)
        self.queries = (Query * BATCH)()
        self.kept = []
        for q, query in enumerate(self.queries):
            poses = (Pose * 2)()
            for h, pose in enumerate(poses):
                values = np.ascontiguousarray(rotations[q, h]).ravel()
                self.kept.append(values)
                pose.root_position = (ctypes.c_double * 3)(*roots[q, h])
                pose.rotations = values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
                pose.num_joints = character.num_joints
            frame = self.positions[q]
            query.struct_size, query.poses, query.num_poses = ctypes.sizeof(Query), poses, 2
            query.positions = Rows(frame.ctypes.data, 0, frame.nbytes)

    def run(self):
        self.library.call("pleat_evaluate", self.evaluator, self.queries, SIZE(BATCH))


def main():
    take = pleat.performer(NUM_FRAMES, NUM_VERTICES)
    character = pleat.train(take, learner="gp")
    motion = character.fit(take)
    order = np.stack([np.arange(1, BATCH + 1), np.arange(BATCH)], axis=1)
    roots, rotations = motion.root_positions[order], motion.rotations[order]
    c = CBatch(sys.argv[1], character, roots, rotations)
    out = np.empty_like(c.positions)
    ratios, times = [], []
    for _ in range(NUM_PAIRS):
        begin = time.perf_counter()
        c.run()
        middle = time.perf_counter()
        character.evaluate_poses(roots, rotations, out=out)
        end = time.perf_counter()
        ratios.append((end - middle) / (middle - begin))
        times.append((end - middle) / BATCH)
    assert np.array_equal(out, c.positions), "the frames differ"
    print(f"{character.num_vertices} vertices, batches of {BATCH}: a query takes {1e6 * statistics.median(times):.0f} us "
          f"in Python, {statistics.median(ratios):.3f} times the C interface")


if __name__ == "__main__":
    main()
