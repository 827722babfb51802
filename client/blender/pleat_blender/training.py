"""One training at a time, on a thread: upload, train, watch, download. Nothing here knows Blender."""

import threading

from .library import PleatError
from .service import Server, Take


class TrainingRun(threading.Thread):
    """Reads or takes the clip, and ends with `data`, the bytes of the model, or with `error`."""

    def __init__(self, address, token, make_take, name="", options=None):
        """make_take: called on the thread with a progress function; returns a Take."""
        super().__init__(name="pleat training", daemon=True)
        self._address, self._token, self._make_take = address, token, make_take
        self._name, self._options = name, options or {}
        self._cancelled = False
        self._job = None
        self.stage, self.fraction, self.eta_seconds = "read", 0.0, -1.0
        self.notes, self.model_id, self.data, self.error = [], "", None, None

    def cancel(self):
        """Ends it within a second; a job on the server is cancelled too."""
        self._cancelled = True

    @property
    def done(self):
        return not self.is_alive() and (self.data is not None or self.error is not None)

    def _report(self, stage, fraction):
        self.stage, self.fraction, self.eta_seconds = stage, fraction, -1.0
        return self._cancelled

    def _observe(self, state, stage, fraction, eta_seconds):
        self.stage, self.fraction, self.eta_seconds = stage if state == "running" else state, fraction, eta_seconds
        return self._cancelled

    def run(self):
        try:
            self._run()
        except PleatError as error:
            self.error = PleatError("CANCELLED", "cancelled") if self._cancelled else error
        except Exception as error:  # noqa: BLE001: the interface shows it
            self.error = PleatError("INTERNAL", f"{type(error).__name__}: {error}")

    def _run(self):
        take = self._make_take(self._report)
        self.notes = take.notes
        self._report("connect", 0)
        server = Server(self._address, self._token)
        sequence_id = server.upload(take, self._report)
        job_id = server.train([sequence_id], self._name, self._options)
        try:
            self.model_id = server.watch(job_id, self._observe)
        except PleatError:
            if self._cancelled:
                server.cancel(job_id)
            raise
        self.data = server.download(self.model_id, self._report)


def file_take(path):
    return lambda report: Take.of_file(path, report)


def array_take(positions, face_sizes, corners, frame_rate, name):
    return lambda report: Take.of_arrays(positions, face_sizes, corners, frame_rate, name)
