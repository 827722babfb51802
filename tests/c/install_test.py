"""Installs the library into a folder of its own and builds the program of docs/guide/game_engine.md
against it, with pkg-config and with CMake, as the page says.

usage: install_test.py BUILD_FOLDER FOLDER_OF_A_CHARACTER
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from guide import block_named, blocks_of

PAGE = "game_engine.md"


def run(*command, folder, environment):
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def check_output(output):
    """Sixty frames in which the first vertex moves or stays, with numbers throughout."""
    lines = output.strip().splitlines()
    assert len(lines) == 60, output
    number = r"-?\d+\.\d+"
    for line in lines:
        assert re.fullmatch(rf"{number} s: vertex 0 at {number} {number} {number}, confidence {number}", line), line


def main():
    build, character = map(pathlib.Path, sys.argv[1:3])
    for tool in ("cmake", "pkg-config", "cc"):
        if shutil.which(tool) is None:
            print(f"skipped: {tool} is not on this machine")
            sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        environment = dict(os.environ)
        run("cmake", "--install", build, "--component", "engine", "--prefix", folder / "first", folder=folder,
            environment=environment)
        prefix = folder / "moved"  # an installed tree may be moved
        (folder / "first").rename(prefix)
        library_folder = next(prefix.rglob("libpleat_eval.so")).parent
        environment["PKG_CONFIG_PATH"] = str(library_folder / "pkgconfig")
        environment["LD_LIBRARY_PATH"] = str(library_folder)
        environment["CMAKE_PREFIX_PATH"] = str(prefix)

        work = folder / "work"
        work.mkdir()
        shutil.copy(character / "character.pleat", work)
        (work / "play.c").write_text(block_named(PAGE, "c", "play.c"))
        shell = blocks_of(PAGE, "sh")
        assert len(shell) == 1
        check_output(run("bash", "-euc", shell[0], folder=work, environment=environment))

        (work / "CMakeLists.txt").write_text(block_named(PAGE, "cmake", "CMakeLists.txt"))
        run("cmake", "-B", "build", "-G", "Ninja", folder=work, environment=environment)
        run("cmake", "--build", "build", folder=work, environment=environment)
        check_output(run("build/play", "character.pleat", folder=work, environment=environment))
    print("the program of the guide runs, built with pkg-config and with CMake")


if __name__ == "__main__":
    main()
