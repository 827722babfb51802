"""The add-on as it is shipped, unpacked so that its parts can be imported without Blender."""

import atexit
import os
import pathlib
import sys
import tempfile
import zipfile

_folder = tempfile.TemporaryDirectory()
atexit.register(_folder.cleanup)
with zipfile.ZipFile(os.environ["PLEAT_ADDON"]) as archive:
    archive.extractall(_folder.name)
sys.path.insert(0, _folder.name)

CHARACTER = pathlib.Path(os.environ["PLEAT_CHARACTER"])  # what tests/c/write_character.cpp wrote
PLEATD = os.path.join(os.environ["PLEAT_BIN"], "pleatd")
