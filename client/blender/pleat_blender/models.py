"""Model files on this machine: those that were downloaded, by their id, and characters that were read from them."""

import hashlib
import pathlib

import bpy

from .character import Character
from .library import PleatError

_read = {}  # Character by id


def folder():
    return pathlib.Path(bpy.utils.user_resource("DATAFILES", path="pleat", create=True))


def keep(data):
    """Keeps a model file and returns its id, which is the SHA-256 of the bytes, and its path."""
    model_id = hashlib.sha256(data).hexdigest()
    path = folder() / f"{model_id}.pleat"
    if not path.exists():
        part = path.with_suffix(".part")
        part.write_bytes(data)
        part.replace(path)
    return model_id, path


def read(data):
    """The character of a model file, and its id. Raises what is wrong with the bytes."""
    model_id = hashlib.sha256(data).hexdigest()
    if model_id not in _read:
        _read[model_id] = Character(data)
    return _read[model_id], model_id


def load(settings):
    """The character of an armature's settings."""
    if settings.model_id in _read:
        return _read[settings.model_id]
    for path in (folder() / f"{settings.model_id}.pleat", pathlib.Path(bpy.path.abspath(settings.model_path or "//"))):
        if path.is_file():
            character, model_id = read(path.read_bytes())
            if model_id == settings.model_id:
                return character
    raise PleatError("NOT_FOUND", f"the model {settings.model_id[:12]}... is not on this machine: download it from its "
                                  "server, or open its file, and this character will use it")


def forget():
    _read.clear()
