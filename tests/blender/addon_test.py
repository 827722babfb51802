"""Installs the add-on in a Blender without a window and works with it, on a server that runs (in_blender.py)."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FOLDER = pathlib.Path(__file__).parent
ROOT = FOLDER.parents[1]


def check_versions():
    """One release has one number, wherever it stands."""
    project = re.search(r"project\(pleat VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    package = ROOT / "client/blender/pleat_blender"
    manifest = re.search(r'^version = "([\d.]+)"', (package / "blender_manifest.toml").read_text(), re.MULTILINE)[1]
    info = re.search(r'"version": \(([\d, ]+)\)', (package / "__init__.py").read_text())[1].replace(", ", ".")
    assert project == manifest == info, (project, manifest, info)


def main():
    check_versions()
    blender = shutil.which("blender")
    if blender is None:
        print("skipped: blender is not on this machine")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, HOME=folder, XDG_CONFIG_HOME=f"{folder}/config", XDG_CACHE_HOME=folder,
                           PLEAT_WORK=folder)
        for name in ("BLENDER_USER_SCRIPTS", "PLEAT_SERVER", "PLEAT_TOKEN"):
            environment.pop(name, None)
        done = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "3", "-P",
                               str(FOLDER / "in_blender.py")], env=environment, capture_output=True, text=True,
                              timeout=800)
    print(done.stdout[-8000:], done.stderr[-8000:])
    if done.returncode != 0 or "the add-on works" not in done.stdout:
        sys.exit("the add-on does not work in Blender")


if __name__ == "__main__":
    main()
