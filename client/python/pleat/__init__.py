"""Pleat in this process: mesh animations become characters, and poses become meshes.

Positions are float32 arrays of meters, Y up: frames x vertices x 3. Rotations are float64 unit quaternions
x, y, z, w: frames x joints x 4, relative to the parent and written in the axes of the rest pose, in which all
are 0, 0, 0, 1. What goes wrong raises `Error`, whose text says what, where, and what to do.

A function that takes long takes `progress`, which is called with the name of a stage and the share of the
whole that is done; what it raises, or an interrupt from the keyboard, ends the work and is raised. Other
threads run meanwhile. `threads` = 0 means one per core; results never depend on it.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any

from . import _pleat
from ._pleat import Character, Error, Motion, Rig, Sequence, __version__

__all__ = ["Character", "Error", "Motion", "Rig", "Sequence", "__version__", "compress", "decompress", "experiment",
           "experiment_names", "load", "performer", "read", "rig", "save", "train"]

ProgressFunction = Callable[[str, float], object]


def read(path: str | os.PathLike[str], *, fps: float | Fraction | None = None, object: str = "",
         notes: list[str] | None = None, progress: ProgressFunction | None = None) -> Sequence:
    """Reads a mesh sequence: everything that `pleat` reads, but Draco.

    fps: in place of the input's own rate. object: which mesh of an Alembic archive. notes: a list to which is added
    what the reader left out or doubts.
    """
    sequence, texts = _pleat.read(os.fspath(path), fps, object, progress)
    if notes is not None:
        notes.extend(texts)
    return sequence


def performer(num_frames: int = 200, num_vertices: int = 6000, *, seed: int = 1) -> Sequence:
    """A generated dancer in a skirt, for where no capture is at hand."""
    return _pleat.performer(num_frames, num_vertices, seed)


def rig(sequence: Sequence, *, rest_frame: int = -1, threads: int = 0,
        progress: ProgressFunction | None = None) -> Rig:
    """Finds the skeleton of a human-like body and its skinning weights. rest_frame: -1 = found."""
    return _pleat.rig(sequence, rest_frame, threads, progress)


def train(clips: Sequence | Iterable[Sequence], *, threads: int = 0, progress: ProgressFunction | None = None,
          **options: Any) -> Character:
    """Turns clips of one mesh into a character.

    options: the training options by the names of docs/options.md, for example learner="gp", seed=2. The same clips,
    options and seed give the same bytes.
    """
    taken = [clips] if isinstance(clips, Sequence) else list(clips)
    return _pleat.train(taken, options, threads, progress)


def load(path: str | os.PathLike[str]) -> Character:
    """Reads a model file (.pleat). One of a later version is refused with words."""
    with open(path, "rb") as file:
        return Character.from_bytes(file.read())


def save(character: Character, path: str | os.PathLike[str]) -> None:
    """Writes a model file."""
    with open(path, "wb") as file:
        file.write(character.to_bytes())


def compress(sequence: Sequence, *, max_error_mm: float | None = None, kg_percent: float | None = None,
             grid_bits: int | None = None, threads: int = 0,
             progress: ProgressFunction | None = None) -> tuple[bytes, dict[str, float]]:
    """Compresses a sequence to the bytes of a .plt file with one promise, and says what was measured on them."""
    return _pleat.compress(sequence, max_error_mm, kg_percent, grid_bits, threads, progress)


def decompress(data: bytes, *, progress: ProgressFunction | None = None) -> Sequence:
    """Reads the bytes of a .plt file."""
    return _pleat.decompress(data, progress)


def experiment_names() -> list[str]:
    """The comparisons of the paper."""
    return _pleat.experiment_names()


def experiment(sequence: Sequence, name: str, *, protocol: str = "reconstruct", paper_options: bool = True,
               threads: int = 0, progress: ProgressFunction | None = None) -> list[dict[str, Any]]:
    """Makes one of the paper's comparisons. Each row has the keys group, name and report.

    protocol: reconstruct (as in the paper), every5th, blocks10 or last30. paper_options: the published settings
    in place of ours.
    """
    return _pleat.experiment(sequence, name, protocol, paper_options, threads, progress)
