# Plays the poses of a folder and compares every vertex with the frames beside them
# (tests/c/write_character.cpp), without a window:
#   PLEAT_CHARACTER=FOLDER godot3-server --path client/examples/godot -s play.gd
extends SceneTree

const FRAMES_PER_SECOND = 25.0

func read(name):
	var file = File.new()
	if file.open(OS.get_environment("PLEAT_CHARACTER") + "/" + name, File.READ) != OK:
		fail("cannot read " + name)
		return PoolByteArray()
	var bytes = file.get_buffer(file.get_len())
	file.close()
	return bytes

func fail(words):
	printerr(words)
	OS.exit_code = 1

func play():
	var character = MeshInstance.new()
	character.set_script(load("res://character.gd"))
	get_root().add_child(character)
	if character.open(PoolByteArray([1, 2, 3])):
		return fail("three bytes became a character")
	if not character.open(read("character.pleat")):
		return fail("the character cannot be read")
	var poses = read("poses.f64")
	var frames = StreamPeerBuffer.new()
	frames.data_array = read("frames.f32")
	var num_frames = read("confidence.f64").size() / 8
	var pose_bytes = poses.size() / num_frames
	var num_vertices = frames.get_size() / num_frames / 12
	for t in range(num_frames):
		if not character.push(t / FRAMES_PER_SECOND, poses.subarray(t * pose_bytes, (t + 1) * pose_bytes - 1)):
			return fail("frame %d cannot be shown" % t)
		var positions = character.arrays[Mesh.ARRAY_VERTEX]
		var normals = character.arrays[Mesh.ARRAY_NORMAL]
		if positions.size() != num_vertices:
			return fail("%d vertices, not %d" % [positions.size(), num_vertices])
		for v in range(num_vertices):
			var expected = Vector3(frames.get_float(), frames.get_float(), frames.get_float())
			# Vector3's own comparison is approximate.
			if positions[v].x != expected.x or positions[v].y != expected.y or positions[v].z != expected.z:
				return fail("frame %d, vertex %d: %s, not %s" % [t, v, positions[v], expected])
			if abs(normals[v].length() - 1) > 1e-3:
				return fail("frame %d, vertex %d has no unit normal" % [t, v])
	if character.mesh.get_surface_count() != 1 or character.mesh.get_aabb().size.y < 1:
		return fail("the mesh does not hold the character")
	character.close()
	get_root().remove_child(character)
	character.free()
	print("%d frames of %d vertices are equal to Pleat's own" % [num_frames, num_vertices])

func _init():
	play()
	quit()
