"""Plays a character in Godot, without a window, and compares its frames with our own.

usage: godot_test.py PLUGIN LIBRARY FOLDER_OF_A_CHARACTER
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

EXAMPLE = pathlib.Path(__file__).parents[2] / "client/examples/godot"


def main():
    plugin, library, character = map(pathlib.Path, sys.argv[1:4])
    godot = shutil.which("godot3-server")
    if godot is None:
        print("skipped: godot3-server is not on this machine")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        project = pathlib.Path(folder) / "project"
        shutil.copytree(EXAMPLE, project)
        shutil.copy(plugin, project / "libpleat_godot.so")
        shutil.copy(library, project / "libpleat_eval.so.0")
        environment = dict(os.environ, PLEAT_CHARACTER=str(character.resolve()), HOME=folder, XDG_DATA_HOME=folder,
                           LD_LIBRARY_PATH=str(project))
        done = subprocess.run([godot, "--path", str(project), "-s", "play.gd"], env=environment,
                              capture_output=True, text=True, timeout=240)
    print(done.stdout, done.stderr)
    if done.returncode != 0 or "are equal to Pleat's own" not in done.stdout:
        sys.exit("Godot does not show what we show")


if __name__ == "__main__":
    main()
