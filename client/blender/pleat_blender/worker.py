"""A thread that turns poses into meshes while the interface goes on. Nothing here knows Blender.

The newest request wins: one that waits is replaced. Results are taken by the interface when it has time.
"""

import dataclasses
import threading
import time

import numpy as np

from . import axes, heat
from .character import Evaluator, blend
from .library import PleatError
from .service import CONTENT_PARAMETERS, Session

RETRY_SECONDS = 2.0


@dataclasses.dataclass
class Request:
    number: int
    roots: np.ndarray  # H x 3, Pleat's axes
    rotations: np.ndarray  # H x J x 4
    strength: float = 1.0
    with_heat: bool = False


@dataclasses.dataclass
class Result:
    number: int
    positions: np.ndarray | None = None  # V x 3, Blender's axes; None: there is an error
    confidence: float = 0.0
    colors: np.ndarray | None = None  # V x 4
    error: PleatError | None = None
    seconds: float = 0.0  # that the frame took


class InProcess:
    """Evaluates here."""

    def __init__(self, character):
        self.character, self._evaluator = character, Evaluator(character)

    def frame(self, request, out):
        return self._evaluator.evaluate(request.roots, request.rotations, out, request.strength)


class OnServer:
    """Asks a server. While it is away, it is asked again every two seconds at most."""

    def __init__(self, character, address, model_id, token="", content=CONTENT_PARAMETERS, position_bits=16):
        self._open = lambda: Session(address, model_id, token, content, position_bits)
        self.character, self._session, self._evaluator = character, None, Evaluator(character)
        self._skinned = np.empty((character.num_vertices, 3), np.float32)
        self._away, self._away_since = None, 0.0

    def frame(self, request, out):
        if request.strength == 0:
            return self._evaluator.evaluate(request.roots, request.rotations, out, 0)
        if self._away and time.monotonic() - self._away_since < RETRY_SECONDS:
            raise self._away
        try:
            if self._session is None:
                self._session = self._open()
                if self._session.num_vertices != self.character.num_vertices:
                    raise PleatError("FAILED_PRECONDITION", f"the server's model has {self._session.num_vertices} "
                                     f"vertices and this one {self.character.num_vertices}: download it again")
            confidence = self._session.frame(request.roots, request.rotations, out)
            self._away = None
        except PleatError as error:
            if self._session is None or self._session.ended:
                self._session, self._away, self._away_since = None, error, time.monotonic()
            raise
        if request.strength != 1:
            self._evaluator.evaluate(request.roots[:1], request.rotations[:1], self._skinned, 0)
            blend(self._skinned, out, request.strength)
        return confidence


class Worker(threading.Thread):
    def __init__(self, make_source, weights=None):
        """make_source: called on the thread. weights: V x J, of heat.vertex_weights, for requests with heat."""
        super().__init__(name="pleat", daemon=True)
        self._make_source, self._weights = make_source, weights
        self._changed = threading.Condition()
        self._request = self._result = None
        self._busy_since, self._stopped = None, False
        self.start()

    def submit(self, request):
        with self._changed:
            self._request = request
            if self._busy_since is None:
                self._busy_since = time.monotonic()
            self._changed.notify_all()

    def take(self, number=None, timeout=0.0):
        """The newest result, once, or None. With a number it waits for that result or a later one, at most `timeout`."""
        with self._changed:
            if number is not None and timeout > 0:
                self._changed.wait_for(lambda: self._result is not None and self._result.number >= number, timeout)
            result, self._result = self._result, None
            return result

    def waiting_seconds(self):
        """For how long a request has been waiting for its result."""
        with self._changed:
            return 0.0 if self._busy_since is None else time.monotonic() - self._busy_since

    def stop(self, timeout=2.0):
        """Ends the thread. One that waits for a server which hangs is left behind and ends by itself."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()
        self.join(timeout)

    def run(self):
        source = None
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._stopped or self._request is not None)
                if self._stopped:
                    return
                request, self._request = self._request, None
            try:
                source = source or self._make_source()
                result = self._answer(source, request)
            except PleatError as error:
                result = Result(request.number, error=error)
            except Exception as error:  # noqa: BLE001: whatever it is, the interface says it and goes on
                result = Result(request.number, error=PleatError("INTERNAL", f"{type(error).__name__}: {error}"))
            with self._changed:
                self._result = result
                self._busy_since = time.monotonic() if self._request is not None else None
                self._changed.notify_all()

    def _answer(self, source, request):
        began = time.monotonic()
        out = np.empty((source.character.num_vertices, 3), np.float32)
        confidence = source.frame(request, out)
        result = Result(request.number, axes.to_blender(out), confidence)
        if request.with_heat and self._weights is not None:
            joints = source.character.joint_confidence(request.roots, request.rotations)
            result.colors = heat.colors(self._weights @ joints.astype(np.float32))
        result.seconds = time.monotonic() - began
        return result
