"""How fast the add-on shows folds: blender -b --factory-startup -P show_speed.py -- ADDON.zip CHARACTER.pleat SECONDS

Plays a motion of all joints and prints for each way of making the mesh, drawing aside, the frames per second: with a
worker that makes the mesh while Blender waits for it, which is what playing costs at most.
"""

import math
import pathlib
import sys
import time

import bpy
import numpy as np


def animate(rig, character, armature):
    """A swing of every bone, two keys a second."""
    for frame in range(0, 301, 15):
        rotations = np.zeros((character.num_joints, 4))
        for j in range(character.num_joints):
            half = .12 * math.sin(frame / 9 + j)
            rotations[j] = [half, 0, 0, math.sqrt(1 - half * half)]
        armature.write_pose(rig, character, character.joint_positions[0], rotations)
        for bone in rig.pose.bones:
            bone.keyframe_insert("rotation_quaternion", frame=frame)


def play(seconds):
    """Milliseconds of every frame, by the clock and of processor time of all threads together."""
    times, frame, end = [], 0, time.perf_counter() + seconds
    processor = time.process_time()
    while time.perf_counter() < end:
        frame = frame % 300 + 1
        began = time.perf_counter()
        bpy.context.scene.frame_set(frame)
        bpy.context.view_layer.update()
        times.append(1000 * (time.perf_counter() - began))
    return np.array(times), 1000 * (time.process_time() - processor) / len(times)


def main():
    addon, model, seconds = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.preferences.addon_install(filepath=addon)
    bpy.ops.preferences.addon_enable(module="pleat_blender")
    bpy.context.preferences.addons["pleat_blender"]  # noqa: B018: an add-on that is refused stops here
    from pleat_blender import armature, models
    bpy.ops.pleat.open(filepath=str(pathlib.Path(model).resolve()))
    rig = bpy.context.object
    character = models.load(rig.pleat)
    animate(rig, character, armature)
    print(f"{character.num_vertices} vertices, learner {character.learner}")
    rig.pleat.live = False
    rows = [("Blender's own skinning", False, False, 1), ("folds", True, False, 1),
            ("folds at strength 1.5", True, False, 1.5), ("folds and confidence colors", True, True, 1)]
    for name, live, colors, strength in rows:
        rig.pleat.live, rig.pleat.show_heat, rig.pleat.strength = live, colors, strength
        play(.5)
        times, processor = play(float(seconds))
        print(f"{name}: {1000 / times.mean():.0f} frames per second, median {np.median(times):.1f} ms, 99 % "
              f"{np.percentile(times, 99):.1f} ms, processor {processor:.1f} ms")


main()
