# blender -b -P blender_character.py -- FOLDER: what Blender shows of FOLDER/figure.glb and
# FOLDER/figure.bvh, as text: mesh.txt, the vertices of each frame, and joints.txt, "FRAME JOINT x y z".
# Then it writes FOLDER/back.glb: its own export of what it read. Y points up, in meters.
import builtins
import sys

import bpy
import numpy

folder = sys.argv[sys.argv.index('--') + 1]
num_frames, fps = int(sys.argv[-2]), int(sys.argv[-1])
numpy.bool = bool  # the importer of Blender 3.4 was written for an older numpy


def y_up(v):
    return '%.9g %.9g %.9g' % (v.x, v.z, -v.y)


def empty_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = fps  # keys in seconds become frames
    bpy.context.scene.frame_start = 0
    bpy.context.scene.frame_end = num_frames - 1


def show_glb():
    empty_scene()
    bpy.ops.import_scene.gltf(filepath=folder + '/figure.glb')
    mesh = next(o for o in bpy.data.objects if o.type == 'MESH' and o.vertex_groups)
    with open(folder + '/mesh.txt', 'w') as out:
        for frame in range(num_frames):
            bpy.context.scene.frame_set(frame)
            shown = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
            for vertex in shown.to_mesh().vertices:
                out.write(y_up(shown.matrix_world @ vertex.co) + '\n')
            shown.to_mesh_clear()
    bpy.ops.export_scene.gltf(filepath=folder + '/back.glb', export_format='GLB',
                              export_force_sampling=True, export_optimize_animation_size=False)


def show_bvh():
    empty_scene()
    real_open = builtins.open
    builtins.open = lambda path, mode='r', *more, **named: real_open(
        path, mode.replace('U', ''), *more, **named)
    # The importer keeps its start for the rest pose and puts the first frame after it.
    bpy.ops.import_anim.bvh(filepath=folder + '/figure.bvh', global_scale=.01, axis_forward='-Z',
                            axis_up='Y', frame_start=0)
    builtins.open = real_open
    armature = next(o for o in bpy.data.objects if o.type == 'ARMATURE')
    with open(folder + '/joints.txt', 'w') as out:
        for frame in range(num_frames):
            bpy.context.scene.frame_set(frame + 1)
            for bone in armature.pose.bones:
                out.write('%d %s %s\n' % (frame, bone.name, y_up(armature.matrix_world @ bone.head)))


show_glb()
show_bvh()
