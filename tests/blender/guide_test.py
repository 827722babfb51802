"""Runs the script of docs/guide/blender.md as the page says, on a server and a file of its own."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from guide import block_named
from server_process import ServerProcess

BIN = pathlib.Path(os.environ["PLEAT_BIN"])
# The file of the page: a mesh with a Mesh Cache modifier, which is the active object.
SCENE = """
import bpy
bpy.ops.preferences.addon_install(filepath={addon!r})
bpy.ops.preferences.addon_enable(module="pleat_blender")
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath={folder!r} + "/made/performer.obj")
modifier = bpy.context.object.modifiers.new("cache", "MESH_CACHE")
modifier.cache_format, modifier.filepath = "PC2", {folder!r} + "/made/performer.pc2"
modifier.frame_start = bpy.context.scene.frame_start = 1
bpy.context.scene.frame_end, bpy.context.scene.render.fps = 20, 30
bpy.ops.wm.save_as_mainfile(filepath={folder!r} + "/scene.blend")
"""


def main():
    blender = shutil.which("blender")
    if blender is None:
        print("skipped: blender is not on this machine")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder, ServerProcess(BIN / "pleatd", f"{folder}/store") as server:
        environment = dict(os.environ, HOME=folder, PWD=folder, XDG_CONFIG_HOME=f"{folder}/config",
                           PLEAT_SERVER=server.address)

        def run(*command):
            done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=600)
            if done.returncode != 0:
                sys.exit(f"{command}\n{done.stdout}{done.stderr}")
            return done.stdout

        run(BIN / "pleat", "generate", "performer", "-o", "made", "--frames", "20", "--vertices", "700")
        (pathlib.Path(folder) / "make.py").write_text(SCENE.format(addon=os.environ["PLEAT_ADDON"], folder=folder))
        run(blender, "-b", "--factory-startup", "--python-exit-code", "3", "-P", "make.py")
        (pathlib.Path(folder) / "bake.py").write_text(block_named("blender.md", "python", "bake.py"))
        shown = run(blender, "-b", "scene.blend", "--python-exit-code", "3", "-P", "bake.py")
        assert "has 18 bones" in shown, shown
        size = (pathlib.Path(folder) / "folds.pc2").stat().st_size
        vertices = (pathlib.Path(folder) / "made/performer.obj").read_text().count("\nv ")
        assert (size - 32) % (20 * 12) == 0 and abs((size - 32) // (20 * 12) - vertices) <= 1, (size, vertices)
    print("the script of the guide trains and bakes")


if __name__ == "__main__":
    main()
