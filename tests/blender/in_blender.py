"""What addon_test.py runs in Blender: the way of an artist from a mesh cache to baked folds.

Frames are compared with the server's own answer, which `pleat pose MODEL_ID` writes.
"""

import json
import os
import pathlib
import random
import subprocess
import sys
import time

import bpy
import numpy as np

sys.path[:0] = [str(pathlib.Path(__file__).parent), str(pathlib.Path(__file__).parents[1] / "support")]
from server_process import ServerProcess  # noqa: E402

BIN, WORK = pathlib.Path(os.environ["PLEAT_BIN"]), pathlib.Path(os.environ["PLEAT_WORK"])
NUM_FRAMES, PATIENCE = 24, 60.0
CLOSE_MM = .01  # what the mesh may differ from the server's


def pleat(*arguments):
    done = subprocess.run([BIN / "pleat", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, (arguments, done.stdout, done.stderr)
    return done.stdout


def install():
    bpy.ops.preferences.addon_install(filepath=os.environ["PLEAT_ADDON"])
    bpy.ops.preferences.addon_enable(module="pleat_blender")
    assert "pleat_blender" in bpy.context.preferences.addons
    return bpy.context.preferences.addons["pleat_blender"].preferences


def refused(words, operator, **arguments):
    """The operator reports an error with these words, which a script sees as an exception."""
    try:
        operator(**arguments)
    except RuntimeError as error:
        assert words in str(error), (words, str(error))
    else:
        raise AssertionError(f"no error with '{words}'")


def shown_mm(mesh):
    """What the viewport shows of the mesh, in millimeters of the world: V x 3."""
    graph = bpy.context.evaluated_depsgraph_get()
    shown = mesh.evaluated_get(graph)
    data = shown.to_mesh()
    positions = np.empty(3 * len(data.vertices), np.float32)
    data.vertices.foreach_get("co", positions)
    shown.to_mesh_clear()
    world = np.array(mesh.matrix_world)
    return 1000 * (positions.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3])


def import_cache():
    """The performer as an artist has it: a mesh with a Mesh Cache modifier."""
    pleat("generate", "performer", "-o", WORK / "made", "--frames", NUM_FRAMES, "--vertices", 900)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="pleat_blender")  # the settings were those of the factory
    bpy.ops.wm.obj_import(filepath=str(WORK / "made/performer.obj"))
    cache = bpy.context.object
    modifier = cache.modifiers.new("Mesh Cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", str(WORK / "made/performer.pc2")
    modifier.frame_start = 1
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = 30, 1, NUM_FRAMES
    return cache


def train(cache):
    panel = bpy.context.window_manager.pleat
    panel.learner = "gp"
    assert bpy.ops.pleat.train() == {"FINISHED"}
    assert panel.status == "trained" and panel.fraction == 1
    rig = bpy.context.object
    assert rig.type == "ARMATURE" and rig.pleat.live and not rig.pleat.problem, rig.pleat.problem
    assert rig.name.startswith(cache.name) and len(rig.data.bones) == 18
    assert len(rig.pleat.mesh.data.vertices) == len(cache.data.vertices)
    return rig


def check_upload(rig):
    """What was uploaded is the file's own take, so a server with both has stored one sequence."""
    taken = json.loads(pleat("sequences", "--server", rig.pleat.address, "--json"))
    sequence = taken["sequences"][0] if isinstance(taken, dict) else taken[0]
    assert sequence["num_frames"] == NUM_FRAMES, sequence


def animate(rig):
    """A motion of all joints with keys in every fifth frame."""
    from pleat_blender import armature, models
    character, chance = models.load(rig.pleat), random.Random(4)
    for frame in range(1, NUM_FRAMES + 5, 5):
        rotations = np.zeros((character.num_joints, 4))
        for j in range(character.num_joints):
            half = [chance.uniform(-.12, .12) for _ in range(3)]
            rotations[j] = [*half, (1 - sum(h * h for h in half)) ** .5]
        root = character.joint_positions[0] + [.02 * frame, 0, .01]
        armature.write_pose(rig, character, root, rotations)
        for bone in rig.pose.bones:
            bone.keyframe_insert("rotation_quaternion", frame=frame)
        rig.pose.bones[0].keyframe_insert("location", frame=frame)
        bpy.context.view_layer.update()
        found_root, found = armature.read_pose(rig, character)  # there and back
        signs = np.sign(np.sum(found * rotations, axis=1, keepdims=True))
        assert np.abs(found * signs - rotations).max() < 1e-5 and np.abs(found_root - root).max() < 1e-5


def write_motion(rig, path):
    """The motion as a file, with the frame before the first, which is history for Blender and first for pleat."""
    from pleat_blender import armature, models
    character, frames = models.load(rig.pleat), []
    for frame in range(0, NUM_FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        root, rotations = armature.read_pose(rig, character)
        frames.append({"root_translation": root.tolist(), "rotations": rotations[:, [3, 0, 1, 2]].tolist()})
    path.write_text(json.dumps({"schema": "pleat.motion/1", "fps": 30, "joints": character.joint_names,
                                "frames": frames}))


def servers_answer(rig):
    """T x V x 3 millimeters, Blender's axes: what the server itself shows for the motion, frames 1 to T."""
    from pleat_blender import axes
    write_motion(rig, WORK / "motion.json")
    pleat("pose", rig.pleat.model_id, "--motion", WORK / "motion.json", "--server", rig.pleat.address, "--content",
          "parameters", "-o", WORK / "answer.npy", "--force")
    return 1000 * axes.to_blender(np.load(WORK / "answer.npy"))[1:]


def play(rig, frames=range(0, NUM_FRAMES + 1)):
    """Plays frame by frame and returns what is shown in frames 1 to T."""
    shown = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        shown.append(shown_mm(rig.pleat.mesh))
    return np.array(shown)[1:]


def close(name, found, expected, most_mm=CLOSE_MM):
    furthest = float(np.abs(found - expected).max())
    print(f"{name}: furthest {furthest:.5f} mm")
    assert furthest < most_mm, (name, furthest)


def check_skinning(rig):
    """Without Pleat, Blender's own armature shows the skinned mesh."""
    rig.pleat.live = False
    skinned = play(rig)
    rig.pleat.strength, rig.pleat.live = 0, True
    close("skinning by Blender", skinned, play(rig))
    rig.pleat.strength = 1
    return skinned


def check_live(rig, answer):
    for source, content in (("PROCESS", "PARAMETERS"), ("SERVER", "PARAMETERS"), ("SERVER", "MESH")):
        rig.pleat.source, rig.pleat.content, rig.pleat.position_bits = source, content, 20
        assert rig.pleat.live and not rig.pleat.problem
        close(f"live, {source.lower()}, {content.lower()}", play(rig), answer)
    from pleat_blender import live
    assert live.find(rig).status == "" and live.find(rig).confidence >= 0


def check_posing(rig, answer):
    """An edit shows at once, and putting it back shows the frame as it was."""
    from pleat_blender import live
    rig.pleat.source = "PROCESS"
    play(rig, range(0, 12))
    before = shown_mm(rig.pleat.mesh)
    close("frame 11 as played", before, answer[10])
    bone = rig.pose.bones["leftLowerArm" if "leftLowerArm" in rig.pose.bones else rig.pose.bones[-1].name]
    rotation = bone.rotation_quaternion.copy()
    bone.rotation_quaternion = (.9, .43, 0, 0)
    bpy.context.view_layer.update()
    assert np.abs(shown_mm(rig.pleat.mesh) - before).max() > 5
    bone.rotation_quaternion = rotation
    bpy.context.view_layer.update()
    close("the edit taken back", shown_mm(rig.pleat.mesh), before)
    rig.pleat.strength = .5
    assert 0 < np.abs(shown_mm(rig.pleat.mesh) - before).max()
    rig.pleat.strength = 1
    close("the strength put back", shown_mm(rig.pleat.mesh), before)
    assert live.find(rig).status == ""


def check_heat(rig):
    from pleat_blender import heat, models
    rig.pleat.show_heat = True
    bpy.context.scene.frame_set(7)
    attribute = rig.pleat.mesh.data.color_attributes[heat.ATTRIBUTE]
    colors = np.empty(4 * len(attribute.data), np.float32)
    attribute.data.foreach_get("color", colors)
    colors = colors.reshape(-1, 4)
    assert attribute.domain == "POINT" and len(colors) == models.load(rig.pleat).num_vertices
    assert colors[:, :3].std(axis=0).max() > .01, "one color for all"
    rig.pleat.show_heat = False
    assert heat.ATTRIBUTE not in rig.pleat.mesh.data.color_attributes


def check_bakes(rig, answer):
    bpy.context.view_layer.objects.active = rig
    scene = bpy.context.scene
    before = set(bpy.data.objects)
    assert bpy.ops.pleat.bake(target="SHAPE_KEYS") == {"FINISHED"}
    assert bpy.ops.pleat.bake(target="PC2", filepath=str(WORK / "baked.pc2")) == {"FINISHED"}
    assert bpy.ops.pleat.bake(target="ALEMBIC", filepath=str(WORK / "baked.abc")) == {"FINISHED"}
    made = sorted(set(bpy.data.objects) - before, key=lambda found: found.name)
    assert len(made) == 2, made
    for baked in made:
        shown = []
        for frame in range(1, NUM_FRAMES + 1):
            scene.frame_set(frame)
            shown.append(shown_mm(baked))
        close(f"baked, {baked.name}", np.array(shown), answer)
        bpy.data.objects.remove(baked)
    pleat("convert", WORK / "baked.abc", "-o", WORK / "baked.npy")
    from pleat_blender import axes
    close("baked, Alembic", 1000 * axes.to_blender(np.load(WORK / "baked.npy")), answer)
    refused("choose a file", bpy.ops.pleat.bake, target="PC2")


def check_copy(rig):
    """A copy of the character moves its own mesh."""
    from pleat_blender import live
    bpy.context.scene.frame_set(5)
    before = shown_mm(rig.pleat.mesh)
    for found in bpy.data.objects:
        found.select_set(found in (rig, rig.pleat.mesh))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.duplicate()
    copy = bpy.context.object
    assert copy != rig and copy.type == "ARMATURE"
    copy.pleat.live = True
    assert copy.pleat.mesh != rig.pleat.mesh and copy.pleat.key != rig.pleat.key and not copy.pleat.problem
    copy.animation_data_clear()
    copy.pose.bones["head"].rotation_quaternion = (.9, .43, 0, 0)
    bpy.context.view_layer.update()
    assert np.abs(shown_mm(copy.pleat.mesh) - before).max() > 5
    close("the original beside its copy", shown_mm(rig.pleat.mesh), before)
    copy.name, rig.name = "another name", "renamed"
    bpy.context.scene.frame_set(6)
    assert live.find(copy).status == live.find(rig).status == ""
    bpy.data.objects.remove(copy.pleat.mesh)
    copy.pleat.live = False
    bpy.data.objects.remove(copy)


def check_saved_file(rig, skinned):
    """A file holds the rest pose and shows skinning by itself; opened again, the folds come back."""
    bpy.context.scene.frame_set(9)
    live_mesh, name = shown_mm(rig.pleat.mesh), rig.name
    bpy.ops.wm.save_as_mainfile(filepath=str(WORK / "scene.blend"))
    close("after saving", shown_mm(rig.pleat.mesh), live_mesh)
    script = WORK / "plain.py"
    script.write_text("import bpy, numpy as np\nbpy.context.scene.frame_set(9)\n"
                      f"mesh = bpy.data.objects['{rig.pleat.mesh.name}']\n"
                      "shown = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()\n"
                      "values = np.empty(3 * len(shown.vertices), np.float32)\n"
                      "shown.vertices.foreach_get('co', values)\n"
                      f"np.save({str(WORK / 'plain.npy')!r}, values.reshape(-1, 3))\n")
    subprocess.run([bpy.app.binary_path, "-b", "--factory-startup", str(WORK / "scene.blend"), "-P", str(script)],
                   check=True, capture_output=True)
    close("opened without the add-on", 1000 * np.load(WORK / "plain.npy"), skinned[8])
    bpy.ops.wm.open_mainfile(filepath=str(WORK / "scene.blend"))
    rig = bpy.data.objects[name]
    bpy.context.scene.frame_set(8)
    bpy.context.scene.frame_set(9)
    close("opened again", shown_mm(rig.pleat.mesh), live_mesh)
    return rig


def check_server_away(rig, process, skinned, answer):
    """Skinning while the server is away, folds when it is back."""
    from pleat_blender import live
    rig.pleat.source, rig.pleat.content = "SERVER", "PARAMETERS"
    close("before it goes", play(rig, range(0, 6)), answer[:5])
    process.stop()
    bpy.context.scene.frame_set(6)
    close("the server is away", shown_mm(rig.pleat.mesh), skinned[5])
    assert "skinning only" in live.find(rig).status, live.find(rig).status
    with ServerProcess(BIN / "pleatd", WORK / "store", process.address) as again:
        assert again.address == process.address
        began = time.monotonic()
        while live.find(rig).status:  # it asks every two seconds
            assert time.monotonic() - began < PATIENCE, live.find(rig).status
            bpy.context.scene.frame_set(6)
            bpy.context.scene.frame_set(7)
        close("the server is back", shown_mm(rig.pleat.mesh), answer[6])
        rig.pleat.live = False


def check_errors(chosen):
    chosen.address = "127.0.0.1:1"
    refused("no Pleat server answers", bpy.ops.pleat.connect)
    (WORK / "damaged.pleat").write_bytes(b"PLEATMDL" + bytes(300))
    refused("version", bpy.ops.pleat.open, filepath=str(WORK / "damaged.pleat"))
    refused("No such file", bpy.ops.pleat.open, filepath=str(WORK / "none.pleat"))


def main():
    install()
    with ServerProcess(BIN / "pleatd", WORK / "store") as process:
        cache = import_cache()
        chosen = bpy.context.preferences.addons["pleat_blender"].preferences
        chosen.address = process.address
        rig = train(cache)
        check_upload(rig)
        bpy.data.objects.remove(cache)
        animate(rig)
        skinned = check_skinning(rig)
        answer = servers_answer(rig)
        check_live(rig, answer)
        check_posing(rig, answer)
        check_heat(rig)
        check_bakes(rig, answer)
        check_copy(rig)
        assert bpy.ops.pleat.connect() == {"FINISHED"}
        assert len(bpy.context.window_manager.pleat.models) == 1
        assert bpy.ops.pleat.download() == {"FINISHED"}
        bpy.context.object.pleat.live = False
        rig = check_saved_file(rig, skinned)
        check_server_away(rig, process, skinned, answer)
    check_errors(bpy.context.preferences.addons["pleat_blender"].preferences)
    bpy.ops.preferences.addon_disable(module="pleat_blender")
    assert not hasattr(bpy.types.Object, "pleat")
    print("the add-on works")


main()
