# A mesh that a Pleat character moves. Give it poses with push(); it shows them in its own mesh.
extends MeshInstance

var library = GDNative.new()
var loaded = false
var number = -1
var arrays = []

func call_pleat(procedure, arguments):
	var result = library.call_native("standard_varcall", procedure, arguments)
	if typeof(result) == TYPE_STRING:
		push_error(procedure + ": " + result)
	return result

# model: the bytes of a .pleat file. Returns whether it could be read.
func open(model):
	if library.library == null:
		library.library = load("res://pleat.gdnlib")
	if not loaded:
		loaded = library.initialize()
	if not loaded:
		return false
	number = call_pleat("character_open", [model])
	if typeof(number) != TYPE_INT:
		return false
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_INDEX] = call_pleat("character_triangles", [number])
	mesh = ArrayMesh.new()
	return true

# seconds: the time of the game. pose: a PoolByteArray of doubles, the position of the root and then
# x, y, z, w of each joint; StreamPeerBuffer.put_double makes one. Returns whether it could be shown.
func push(seconds, pose):
	if typeof(call_pleat("character_push", [number, seconds, pose])) == TYPE_STRING:
		return false
	var positions = call_pleat("character_positions", [number])
	if typeof(positions) == TYPE_STRING:
		return false
	arrays[Mesh.ARRAY_VERTEX] = positions
	arrays[Mesh.ARRAY_NORMAL] = call_pleat("character_normals", [number])
	while mesh.get_surface_count() > 0:
		mesh.surface_remove(0)
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	return true

func confidence():
	return call_pleat("character_confidence", [number])

func close():
	call_pleat("character_close", [number])
	number = -1
	mesh = null
	library.terminate()
	loaded = false
