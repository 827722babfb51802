"""The compiled part. Shapes: T frames, V vertices, F triangles, J joints, N queries, H poses of each, r coefficients."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float32]
_Doubles = npt.NDArray[np.float64]
_Ints = npt.NDArray[np.int32]
_Progress = Callable[[str, float], object] | None

__version__: str

class Error(RuntimeError):
    code: str  # the name of a status: INVALID_ARGUMENT, DATA_LOSS, ...

class Sequence:
    """A mesh animation; it never changes."""
    def __init__(self, positions: npt.ArrayLike, faces: npt.ArrayLike, *, fps: float | Fraction = 30, name: str = "",
                 face_sizes: npt.ArrayLike | None = None) -> None:
        """positions: T x V x 3. faces: rows of corners, or all corners with the sizes of the faces."""
    @property
    def positions(self) -> _Floats: ...  # T x V x 3, a copy
    @property
    def triangles(self) -> _Ints: ...  # F x 3
    @property
    def corners(self) -> _Ints: ...
    @property
    def face_sizes(self) -> _Ints: ...
    @property
    def fps(self) -> Fraction: ...
    @property
    def name(self) -> str: ...
    @property
    def num_frames(self) -> int: ...
    @property
    def num_vertices(self) -> int: ...
    def __len__(self) -> int: ...
    def frame(self, t: int) -> _Floats: ...  # V x 3, a copy
    def subset(self, frames: list[int]) -> Sequence: ...
    def to_bytes(self) -> bytes: ...  # a sequence file
    @staticmethod
    def from_bytes(data: bytes) -> Sequence: ...

class Rig:
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def parents(self) -> list[int]: ...
    @property
    def joint_positions(self) -> _Doubles: ...  # J x 3
    @property
    def rest_positions(self) -> _Doubles: ...  # V x 3
    @property
    def weights(self) -> _Doubles: ...  # V x J; column j: the bone that ends in joint j
    @property
    def rest_frame(self) -> int: ...
    @property
    def residual(self) -> float: ...  # below .03 it can be trusted
    @property
    def warnings(self) -> list[str]: ...

class Motion:
    """Poses over time."""
    def __init__(self, root_positions: npt.ArrayLike, rotations: npt.ArrayLike, *, fps: float = 30) -> None:
        """root_positions: T x 3. rotations: T x J x 4."""
    @property
    def root_positions(self) -> _Doubles: ...
    @property
    def rotations(self) -> _Doubles: ...
    @property
    def fps(self) -> float: ...
    @property
    def num_frames(self) -> int: ...
    @property
    def num_joints(self) -> int: ...
    def __len__(self) -> int: ...

class Character:
    """A trained character; it never changes, and threads may share it."""
    @staticmethod
    def from_bytes(data: bytes) -> Character: ...
    def to_bytes(self) -> bytes: ...
    @property
    def name(self) -> str: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def parents(self) -> list[int]: ...
    @property
    def joint_positions(self) -> _Doubles: ...  # J x 3
    @property
    def triangles(self) -> _Ints: ...  # F x 3
    @property
    def num_vertices(self) -> int: ...
    @property
    def num_joints(self) -> int: ...
    @property
    def num_coefficients(self) -> int: ...
    @property
    def history(self) -> int: ...  # poses that a query looks at
    @property
    def fps(self) -> float: ...  # of the training; earlier poses are 1 / fps apart
    @property
    def record(self) -> dict[str, Any]: ...  # what the training found out about its own result
    def fit(self, sequence: Sequence, *, threads: int = 0, progress: _Progress = None) -> Motion:
        """The poses of this character in every frame of a sequence of its mesh."""
    def evaluate(self, motion: Motion, *, bone_scales: npt.ArrayLike = ..., skinned_only: bool = False,
                 out: _Floats | None = None, progress: _Progress = None) -> tuple[_Floats, _Doubles]:
        """Positions (T x V x 3) and confidence (T) of every frame; out is written and returned, not copied."""
    def evaluate_poses(self, root_positions: npt.ArrayLike, rotations: npt.ArrayLike, *,
                       bone_scales: npt.ArrayLike = ..., skinned_only: bool = False,
                       out: _Floats | None = None) -> tuple[_Floats, _Doubles]:
        """N x H x 3 and N x H x J x 4 -> N x V x 3 and N. Pose h of a query is h / fps older than pose 0."""
    def predict(self, root_positions: npt.ArrayLike, rotations: npt.ArrayLike, *,
                skinned_only: bool = False) -> tuple[_Doubles, _Floats, _Floats, _Doubles]:
        """The same poses -> root positions, rotations, coefficients (N x r) and confidence, for show."""
    def show(self, root_positions: npt.ArrayLike, rotations: npt.ArrayLike, coefficients: npt.ArrayLike, *,
             bone_scales: npt.ArrayLike = ..., out: _Floats | None = None) -> _Floats:
        """These -> positions, to the same bits on every machine."""

class StreamDecoder:
    """Frames of one stream of a server, in their order; pleat.server uses it."""
    def __init__(self, encoding: int, num_vertices: int, num_points: int, num_triangles: int,
                 origin: tuple[float, float, float], range: float, bits: int, topology: bytes,
                 vertex_order: npt.ArrayLike) -> None: ...
    def decode(self, draco: bytes, difference: bool = False, checksum: int = 0, *,
               out: _Floats | None = None) -> _Floats: ...  # V x 3

def read(path: str, fps: float | Fraction | None, object: str, progress: _Progress) -> tuple[Sequence, list[str]]: ...
def performer(num_frames: int, num_vertices: int, seed: int) -> Sequence: ...
def rig(sequence: Sequence, rest_frame: int, num_threads: int, progress: _Progress) -> Rig: ...
def train(clips: list[Sequence], options: dict[str, Any], num_threads: int, progress: _Progress) -> Character: ...
def compress(sequence: Sequence, max_error_mm: float | None, kg_percent: float | None, grid_bits: int | None,
             num_threads: int, progress: _Progress) -> tuple[bytes, dict[str, float]]: ...
def decompress(data: bytes, progress: _Progress) -> Sequence: ...
def experiment_names() -> list[str]: ...
def experiment(sequence: Sequence, name: str, protocol: str, paper_options: bool, num_threads: int,
               progress: _Progress) -> list[dict[str, Any]]: ...
