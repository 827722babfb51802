"""A character as armature and mesh, and the pose of that armature as Pleat's.

Bone b of Pleat ends in joint b and turns about the joint above it. So the Blender bone with the name of joint b goes
from the joint above to joint b, and the root, in which no bone ends, is a short bone that stands in joint 0. Rotations
of both are relative to the parent; Pleat writes them in the axes of the rest pose, Blender in those of the bone.
"""

import bpy
import mathutils
import numpy as np

from . import axes, heat

ROOT_LENGTH = .12  # of the root's bone, as a share of the height of the skeleton
SHORTEST = 1e-4  # meters; Blender throws shorter bones away
REST = "pleat_rest"  # the attribute with the rest pose, from which the mesh is restored


def build(context, character):
    """Makes both objects in the scene, the mesh below the armature, and returns the armature and the mesh."""
    collection = context.collection
    name = character.name or "Character"
    armature = bpy.data.objects.new(name, bpy.data.armatures.new(name))
    collection.objects.link(armature)
    _make_bones(context, armature, character)
    mesh = bpy.data.objects.new(f"{name} mesh", _make_mesh(f"{name} mesh", character))
    collection.objects.link(mesh)
    mesh.parent = armature
    _make_groups(mesh, character)
    modifier = mesh.modifiers.new("Armature", "ARMATURE")
    modifier.object = armature
    return armature, mesh


def _make_bones(context, armature, character):
    joints = axes.to_blender(character.joint_positions)
    height = float(np.ptp(joints[:, 2])) or 1.0
    for selected in list(context.selected_objects):
        selected.select_set(False)
    context.view_layer.objects.active = armature
    armature.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bones = []
    for j, (joint, parent) in enumerate(zip(joints, character.parents)):
        bone = armature.data.edit_bones.new(character.joint_names[j])
        bones.append(bone)
        head = joints[max(parent, 0)]
        tail = joint if parent >= 0 else joint + (0, 0, ROOT_LENGTH * height)
        if np.linalg.norm(tail - head) < SHORTEST:
            tail = head + (0, 0, 10 * SHORTEST)
        bone.head, bone.tail = head.tolist(), tail.tolist()
        if parent >= 0:
            bone.parent = bones[parent]
            bone.use_connect = parent > 0
    bpy.ops.object.mode_set(mode="OBJECT")
    armature.data.display_type = "STICK"
    armature.show_in_front = True
    for j, bone_name in enumerate(character.joint_names):
        bone = armature.pose.bones[bone_name]
        bone.rotation_mode = "QUATERNION"
        bone.lock_scale = (True, True, True)
        if j > 0:
            bone.lock_location = (True, True, True)


def _make_mesh(name, character):
    mesh = bpy.data.meshes.new(name)
    positions = axes.to_blender(character.rest_positions)
    ends = np.cumsum(character.face_sizes)[:-1]
    faces = [face.tolist() for face in np.split(character.corners, ends)]
    mesh.from_pydata(positions.tolist(), [], faces)
    if len(character.texcoords):
        used = np.where(character.corner_texcoords[:, None] >= 0, character.texcoords[character.corner_texcoords], 0)
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", np.ascontiguousarray(used, np.float32).ravel())
    mesh.attributes.new(REST, "FLOAT_VECTOR", "POINT").data.foreach_set("vector", positions.ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    mesh.update()
    return mesh


def _make_groups(mesh, character):
    bones, weights = character.influences()
    groups = [mesh.vertex_groups.new(name=name) for name in character.joint_names]
    for v, (vertex_bones, vertex_weights) in enumerate(zip(bones.tolist(), weights.tolist())):
        for bone, weight in zip(vertex_bones, vertex_weights):
            if weight > 0:
                groups[bone].add([v], weight, "REPLACE")


def missing_bones(armature, character):
    return [name for name in character.joint_names if name not in armature.pose.bones]


def read_pose(armature, character):
    """The pose of an evaluated armature: the root's position, and J x 4 rotations x, y, z, w, about Pleat's axes.

    What constraints and drivers do is part of it. Bones that are stretched or moved against their parent are taken by
    their rotation alone.
    """
    world = []
    rotations = np.empty((character.num_joints, 4))
    for j, (name, parent) in enumerate(zip(character.joint_names, character.parents)):
        bone = armature.pose.bones[name]
        world.append((bone.matrix @ bone.bone.matrix_local.inverted_safe()).to_quaternion())
        local = world[j] if parent < 0 else world[parent].inverted() @ world[j]
        rotations[j] = axes.rotation_from_blender(*local)
    root = armature.pose.bones[character.joint_names[0]].head
    return axes.from_blender(np.array(root, np.float64)), rotations


def write_pose(armature, character, root, rotations):
    """Sets the pose bones to a pose of Pleat's: 3, and J x 4 rotations x, y, z, w."""
    for j, name in enumerate(character.joint_names):
        bone = armature.pose.bones[name]
        rest = bone.bone.matrix_local.to_quaternion()
        bone.rotation_quaternion = rest.inverted() @ mathutils.Quaternion(
            axes.rotation_to_blender(*rotations[j])) @ rest
        if character.parents[j] < 0:
            offset = mathutils.Vector(axes.to_blender(np.asarray(root) - character.joint_positions[0]).tolist())
            bone.location = bone.bone.matrix_local.to_3x3().inverted() @ offset


def _positions_of(mesh):
    """The place of the positions and what it is called there; Blender 3.5 has made an attribute of them."""
    attribute = mesh.attributes.get("position")
    return (attribute.data, "vector") if attribute is not None else (mesh.vertices, "co")


def _armature_modifier(mesh_object):
    return next((m for m in mesh_object.modifiers if m.type == "ARMATURE"), None)


def _show_modifier(mesh_object, shown):
    modifier = _armature_modifier(mesh_object)
    if modifier is not None and modifier.show_viewport != shown:
        modifier.show_viewport = modifier.show_render = shown


def show_positions(mesh_object, positions):
    """Shows a mesh in place of the skinned one: V x 3 float32."""
    data, name = _positions_of(mesh_object.data)
    data.foreach_set(name, positions.ravel())
    _show_modifier(mesh_object, False)
    mesh_object.data.update()


def show_skinning(mesh_object):
    """Shows what Blender's own armature makes of the rest pose, as without Pleat."""
    modifier = _armature_modifier(mesh_object)
    rest = mesh_object.data.attributes.get(REST)
    if modifier is None or modifier.show_viewport or rest is None:
        return
    positions = np.empty(3 * len(mesh_object.data.vertices), np.float32)
    rest.data.foreach_get("vector", positions)
    show_positions(mesh_object, positions)
    _show_modifier(mesh_object, True)


def show_colors(mesh_object, colors):
    """V x 4 linear colors of the attribute that shows where the confidence is low; None takes it away."""
    attributes = mesh_object.data.color_attributes
    attribute = attributes.get(heat.ATTRIBUTE)
    if colors is None:
        if attribute is not None:
            attributes.remove(attribute)
        return
    if attribute is None:
        attribute = attributes.new(heat.ATTRIBUTE, "FLOAT_COLOR", "POINT")
        attributes.active_color = attribute
    attribute.data.foreach_set("color", np.ascontiguousarray(colors, np.float32).ravel())
