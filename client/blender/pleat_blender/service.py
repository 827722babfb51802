"""A Pleat server: upload, train, watch, download, live sessions. Calls wait, so they belong on a thread of their own.

Nothing here knows Blender.
"""

import ctypes
from ctypes import byref, c_char_p, c_size_t, c_uint32, c_uint64, c_void_p
from fractions import Fraction

import numpy as np

from . import library as c
from .character import poses_of, rows_of

JOB_STATES = ("queued", "running", "succeeded", "failed", "cancelled")
CONTENT_MESH, CONTENT_PARAMETERS = 0, 1
SEND_RESTART = 1


def _bytes_or_none(text):
    return text.encode() if text else None


class Callback:
    """Makes a function of ours one of C's. What it raises ends the call, and `check` raises it again."""

    def __init__(self, kind, function):
        self._raised = None

        def guarded(user, *arguments):
            try:
                return 1 if function(*arguments) else 0
            except BaseException as error:  # noqa: BLE001: no exception may pass through C
                self._raised = error
                return 1

        self.function = kind(guarded)

    def call(self, library, name, *arguments):
        try:
            library.call(name, *arguments)
        except c.PleatError:
            if self._raised is None:
                raise
        if self._raised is not None:
            raise self._raised


def _progress(report):
    """report(stage, fraction) may raise or return True, which ends the call."""
    def passed(stage, fraction):
        return report(stage.decode(), fraction) if report else False
    return Callback(c.PROGRESS, passed)


class Take:
    """A mesh animation on its way to a server or a file."""

    def __init__(self, handle):
        self.library, self.handle = c.serving(), handle
        info = c.TakeInfo()
        self.library.call("pleat_take_get_info", self.handle, byref(info))
        self.num_vertices, self.num_frames = info.num_vertices, info.num_frames
        self.frame_rate = Fraction(info.rate_numerator, info.rate_denominator)
        self.name = self.library.text("pleat_take_name", self.handle)
        self.notes = [self.library.text("pleat_take_note", self.handle, c_uint32(n)) for n in range(info.num_notes)]

    def __del__(self):
        if getattr(self, "handle", None):
            self.library.value("pleat_take_destroy", self.handle)

    @staticmethod
    def of_arrays(positions, face_sizes, corners, frame_rate, name=""):
        """positions: T x V x 3, meters, Y up; face_sizes: of F faces; corners: their vertices; a rate as a fraction."""
        library = c.serving()
        positions = np.ascontiguousarray(positions, np.float32)
        sizes, corners = (np.ascontiguousarray(values, np.uint32) for values in (face_sizes, corners))
        rate = Fraction(frame_rate).limit_denominator(1001)
        mesh = c.TakeMesh(name=name.encode(), num_frames=positions.shape[0], num_vertices=positions.shape[1],
                          face_sizes=sizes.ctypes.data, num_faces=sizes.size, corners=corners.ctypes.data,
                          num_corners=corners.size, rate_numerator=rate.numerator, rate_denominator=rate.denominator)
        handle = c_void_p()
        library.call("pleat_take_create", byref(mesh), c_void_p(positions.ctypes.data), c_size_t(positions.size),
                     byref(handle))
        return Take(handle)

    @staticmethod
    def of_file(path, report=None):
        library, handle, progress = c.serving(), c_void_p(), _progress(report)
        progress.call(library, "pleat_take_read", str(path).encode(), progress.function, None, byref(handle))
        return Take(handle)

    def write(self, path):
        """.abc or .pseq, by the ending."""
        self.library.call("pleat_take_write", self.handle, str(path).encode())


class Server:
    def __init__(self, address, token="", connect_seconds=5):
        self.library, self.handle = c.serving(), c_void_p()
        options = c.ServerOptions(address=address.encode(), token=_bytes_or_none(token),
                                  connect_seconds=connect_seconds)
        self.library.call("pleat_server_connect", byref(options), byref(self.handle))
        self.address = address

    def __del__(self):
        if getattr(self, "handle", None):
            self.library.value("pleat_server_destroy", self.handle)

    def models(self):
        """A list of dictionaries: id, name, learner, num_vertices, num_joints, size_bytes."""
        found = []

        def visit(entry):
            model = entry.contents
            found.append({"id": model.id.decode(), "name": model.name.decode("utf-8", "replace"),
                          "learner": model.learner.decode(), "num_vertices": model.num_vertices,
                          "num_joints": model.num_joints, "size_bytes": model.size_bytes})
        visitor = Callback(c.MODEL_VISITOR, visit)
        visitor.call(self.library, "pleat_server_list_models", self.handle, visitor.function, None)
        return found

    def upload(self, take, report=None):
        progress, sequence_id = _progress(report), ctypes.create_string_buffer(c.ID_SIZE)
        progress.call(self.library, "pleat_server_upload", self.handle, take.handle, progress.function, None,
                      sequence_id)
        return sequence_id.value.decode()

    def train(self, sequence_ids, name="", options=None):
        """Returns the id of the job. options: names of docs/options.md with their values."""
        ids = (c_char_p * len(sequence_ids))(*(text.encode() for text in sequence_ids))
        lines = "\n".join(f"{key}={value}" for key, value in (options or {}).items())
        training = c.Training(sequence_ids=ids, num_sequences=len(ids), name=_bytes_or_none(name),
                              options=lines.encode())
        job_id = ctypes.create_string_buffer(c.ID_SIZE)
        self.library.call("pleat_server_train", self.handle, byref(training), job_id)
        return job_id.value.decode()

    def watch(self, job_id, observe=None):
        """Waits for the job and returns the id of its model; observe(state, stage, fraction, eta_seconds)."""
        def seen(pointer):
            job = pointer.contents
            if observe:
                return observe(JOB_STATES[job.state], job.stage.decode(), job.fraction, job.eta_seconds)
        observer, last = Callback(c.JOB_OBSERVER, seen), c.Job()
        observer.call(self.library, "pleat_server_watch", self.handle, job_id.encode(), observer.function, None,
                      byref(last))
        return last.result_id.decode()

    def cancel(self, job_id):
        self.library.call("pleat_server_cancel", self.handle, job_id.encode())

    def download(self, model_id, report=None):
        taken = []
        taker = c.BYTES_TAKER(lambda user, data, size: taken.append(ctypes.string_at(data, size)))
        progress = _progress(report)
        progress.call(self.library, "pleat_server_download", self.handle, model_id.encode(), progress.function, taker,
                      None)
        return taken[0]


class Session:
    """Poses go out, positions come back. For one thread."""

    def __init__(self, address, model_id, token="", content=CONTENT_PARAMETERS, position_bits=16, connect_seconds=2):
        self.library, self.handle = c.serving(), c_void_p()
        options = c.SessionOptions(address=address.encode(), model_id=model_id.encode(), token=_bytes_or_none(token),
                                   connect_seconds=connect_seconds, content=content, max_reconnects=1,
                                   position_bits=position_bits if content == CONTENT_MESH else 0)
        self.library.call("pleat_session_open", byref(options), byref(self.handle))
        self.num_vertices = self.library.value("pleat_session_num_vertices", self.handle)
        self._number = 0

    def __del__(self):
        if getattr(self, "handle", None):
            self.library.value("pleat_session_destroy", self.handle)

    def frame(self, roots, rotations, out):
        """Sends the poses of one query, waits for its frame, writes it into `out` and returns the confidence."""
        self._number += 1
        poses = poses_of(roots, rotations)
        alone = SEND_RESTART if len(poses) == 1 else 0  # otherwise the poses sent before would be its history
        self.library.call("pleat_session_send_poses", self.handle, c_uint64(self._number), poses, c_size_t(len(poses)),
                          c_uint32(alone))
        frame = c.Frame(positions=rows_of(out))
        while True:
            self.library.call("pleat_session_receive", self.handle, byref(frame))
            if frame.number == self._number:
                return frame.confidence

    @property
    def ended(self):
        return self.library.value("pleat_session_ended", self.handle) != 0
