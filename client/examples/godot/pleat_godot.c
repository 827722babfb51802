/* A GDNative library that shows Pleat characters in Godot 3 (README.md): a thin layer over pleat.h.
 * GDScript calls it with GDNative.call_native("standard_varcall", NAME, [arguments]). A call that
 * fails returns a text, which says why. */
#include <stdlib.h>
#include <string.h>

#include "gdnative.h"
#include "pleat.h"

const GodotApi* godot;

typedef struct Character {
  pleat_model* model; /* NULL: this place is free */
  pleat_evaluator* evaluator;
  pleat_motion* motion;
  pleat_model_info info;
  float* normals; /* of the last frame */
  double confidence;
} Character;

enum { kMostCharacters = 64 };
static Character characters[kMostCharacters];

void godot_gdnative_init(const GodotInitOptions* options) { godot = options->api; }

static void Close(Character* character) {
  pleat_motion_destroy(character->motion);
  pleat_evaluator_destroy(character->evaluator);
  pleat_model_destroy(character->model);
  free(character->normals);
  memset(character, 0, sizeof(*character));
}

void godot_gdnative_terminate(void* options) {
  (void)options;
  for (int i = 0; i < kMostCharacters; ++i) Close(&characters[i]);
}

/* The character whose number is the first argument, or NULL. */
static Character* CharacterOf(const GodotArray* arguments) {
  if (ArraySize(arguments) == 0) return NULL;
  GodotVariant argument = ArrayGet(arguments, 0);
  const int64_t number = VariantAsInt(&argument);
  VariantDestroy(&argument);
  const bool is_open = number >= 0 && number < kMostCharacters && characters[number].model != NULL;
  return is_open ? &characters[number] : NULL;
}

static GodotVariant NotOpen(void) { return NewText("there is no character with this number"); }

static pleat_code OpenModel(const void* bytes, size_t num_bytes, Character* character,
                            pleat_error* error) {
  character->info.struct_size = sizeof(character->info);
  pleat_code code = pleat_model_create(bytes, num_bytes, NULL, &character->model, error);
  if (code == PLEAT_OK) code = pleat_model_get_info(character->model, &character->info, error);
  if (code == PLEAT_OK) {
    code = pleat_evaluator_create(character->model, &character->evaluator, error);
  }
  if (code == PLEAT_OK) code = pleat_evaluator_reserve(character->evaluator, 1, error);
  if (code == PLEAT_OK) code = pleat_motion_create(character->model, &character->motion, error);
  return code;
}

/* character_open(bytes of a .pleat file) -> the number of the character */
GodotVariant character_open(GodotArray* arguments) {
  int number = 0;
  while (number < kMostCharacters && characters[number].model != NULL) ++number;
  if (number == kMostCharacters || ArraySize(arguments) != 1) {
    return NewText("character_open takes the bytes of a model, for up to 64 characters");
  }
  GodotVariant argument = ArrayGet(arguments, 0);
  GodotPool bytes = VariantAsBytes(&argument);
  void* access = NULL;
  const uint8_t* model = BeginRead(&bytes, &access);
  Character* const character = &characters[number];
  pleat_error error;
  const pleat_code code = OpenModel(model, (size_t)NumBytes(&bytes), character, &error);
  EndRead(access);
  DestroyBytes(&bytes);
  VariantDestroy(&argument);
  if (code == PLEAT_OK) {
    character->normals = malloc(3 * sizeof(float) * character->info.num_vertices);
    if (character->normals != NULL) return NewInt(number);
  }
  Close(character);
  return NewText(code == PLEAT_OK ? "no memory is left" : error.message);
}

/* character_close(number) */
GodotVariant character_close(GodotArray* arguments) {
  Character* const character = CharacterOf(arguments);
  if (character == NULL) return NotOpen();
  Close(character);
  return NewInt(0);
}

/* character_triangles(number) -> PoolIntArray for Mesh.ARRAY_INDEX. Godot's front faces run
 * clockwise. */
GodotVariant character_triangles(GodotArray* arguments) {
  const Character* const character = CharacterOf(arguments);
  if (character == NULL) return NotOpen();
  GodotPool ints;
  void* access = NULL;
  const size_t size = 3 * (size_t)character->info.num_triangles;
  int32_t* const indices = BeginInts(&ints, (int)size, &access);
  pleat_model_copy_triangles(character->model, (uint32_t*)indices, size, NULL);
  for (size_t i = 0; i < size; i += 3) {
    const int32_t second = indices[i + 1];
    indices[i + 1] = indices[i + 2];
    indices[i + 2] = second;
  }
  return FinishInts(&ints, access);
}

/* character_push(number, seconds, pose) -> 0. pose: a PoolByteArray of doubles (StreamPeerBuffer),
 * the position of the root and then x, y, z, w of each joint. */
GodotVariant character_push(GodotArray* arguments) {
  Character* const character = CharacterOf(arguments);
  if (character == NULL) return NotOpen();
  if (ArraySize(arguments) != 3) return NewText("character_push takes number, seconds and pose");
  GodotVariant seconds = ArrayGet(arguments, 1), argument = ArrayGet(arguments, 2);
  GodotPool bytes = VariantAsBytes(&argument);
  const size_t num_joints = character->info.num_joints;
  pleat_error error = {PLEAT_INVALID_ARGUMENT, "the pose has another number of joints"};
  pleat_code code = error.code;
  if ((size_t)NumBytes(&bytes) == (3 + 4 * num_joints) * sizeof(double)) {
    void* access = NULL;
    const double* const values = (const double*)(const void*)BeginRead(&bytes, &access);
    pleat_pose pose = {.rotations = values + 3, .num_joints = num_joints};
    memcpy(pose.root_position, values, sizeof(pose.root_position));
    code = pleat_motion_push(character->motion, VariantAsReal(&seconds), &pose, &error);
    EndRead(access);
  }
  DestroyBytes(&bytes);
  VariantDestroy(&argument);
  VariantDestroy(&seconds);
  return code == PLEAT_OK ? NewInt(0) : NewText(error.message);
}

/* character_positions(number) -> PoolVector3Array, evaluated straight into Godot's memory */
GodotVariant character_positions(GodotArray* arguments) {
  Character* const character = CharacterOf(arguments);
  if (character == NULL) return NotOpen();
  const size_t num_bytes = 3 * sizeof(float) * character->info.num_vertices;
  pleat_query query = {.struct_size = sizeof(query)};
  pleat_error error;
  pleat_code code = pleat_motion_poses(character->motion, &query.poses, &query.num_poses, &error);
  if (code != PLEAT_OK) return NewText(error.message);
  GodotPool vectors;
  void* access = NULL;
  query.positions.data = BeginVectors(&vectors, (int)character->info.num_vertices, &access);
  query.positions.num_bytes = num_bytes;
  query.normals.data = character->normals;
  query.normals.num_bytes = num_bytes;
  code = pleat_evaluate(character->evaluator, &query, 1, &error);
  character->confidence = query.confidence;
  GodotVariant result = FinishVectors(&vectors, access);
  if (code == PLEAT_OK) return result;
  VariantDestroy(&result);
  return NewText(error.message);
}

/* character_normals(number) -> PoolVector3Array of the frame that was evaluated last */
GodotVariant character_normals(GodotArray* arguments) {
  const Character* const character = CharacterOf(arguments);
  if (character == NULL) return NotOpen();
  GodotPool vectors;
  void* access = NULL;
  float* const normals = BeginVectors(&vectors, (int)character->info.num_vertices, &access);
  memcpy(normals, character->normals, 3 * sizeof(float) * character->info.num_vertices);
  return FinishVectors(&vectors, access);
}

/* character_confidence(number) -> of that frame */
GodotVariant character_confidence(GodotArray* arguments) {
  const Character* const character = CharacterOf(arguments);
  return character == NULL ? NotOpen() : NewReal(character->confidence);
}
