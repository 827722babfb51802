/* What a game does, in C11: reads a character, takes the host's memory, moves it and compares every
 * frame with what our own evaluator shows (write_character.cpp).  c11_test FOLDER */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pleat.h"

#define CHECK(condition)                                                       \
  do {                                                                         \
    if (!(condition)) {                                                        \
      fprintf(stderr, "%s:%d: %s is false\n", __FILE__, __LINE__, #condition); \
      exit(1);                                                                 \
    }                                                                          \
  } while (0)

static void Expect(pleat_code code, const pleat_error* error, int line) {
  if (code == PLEAT_OK) return;
  fprintf(stderr, "line %d: code %d: %s\n", line, (int)code, error->message);
  exit(1);
}
#define EXPECT_OK(call) Expect((call), &error, __LINE__)

/* The allocator of a host, which knows what it gave. */
typedef struct Heap {
  size_t num_blocks, num_allocations;
} Heap;

static void* Allocate(void* user, size_t size, size_t alignment) {
  Heap* heap = user;
  ++heap->num_blocks;
  ++heap->num_allocations;
  return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void Deallocate(void* user, void* memory) {
  --((Heap*)user)->num_blocks;
  free(memory);
}

static void* ReadWhole(const char* folder, const char* name, size_t* size) {
  char path[4096];
  snprintf(path, sizeof(path), "%s/%s", folder, name);
  FILE* file = fopen(path, "rb");
  CHECK(file != NULL);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  void* bytes = malloc(*size + 1);
  CHECK(fread(bytes, 1, *size, file) == *size);
  fclose(file);
  return bytes;
}

typedef struct Vertex {
  float position[3];
  float texcoord[2];
  float normal[3];
} Vertex;

int main(int argc, char** argv) {
  CHECK(argc == 2);
  CHECK(pleat_api_version() == PLEAT_API_VERSION);
  Heap heap = {0, 0};
  pleat_error error;
  const pleat_allocator allocator = {sizeof(allocator), &heap, Allocate, Deallocate};
  EXPECT_OK(pleat_set_allocator(&allocator, &error));

  size_t size = 0, poses_size = 0, frames_size = 0;
  void* bytes = ReadWhole(argv[1], "character.pleat", &size);
  double* pose_values = ReadWhole(argv[1], "poses.f64", &poses_size);
  float* frames = ReadWhole(argv[1], "frames.f32", &frames_size);
  pleat_model* model = NULL;
  EXPECT_OK(pleat_model_create(bytes, size, NULL, &model, &error));
  free(bytes);
  pleat_model_info info = {.struct_size = sizeof(info)};
  EXPECT_OK(pleat_model_get_info(model, &info, &error));
  const size_t num_joints = info.num_joints, num_vertices = info.num_vertices;
  const size_t values_per_pose = 3 + 4 * num_joints;
  const size_t num_frames = poses_size / sizeof(double) / values_per_pose;
  CHECK(frames_size == num_frames * num_vertices * 3 * sizeof(float));
  CHECK(strcmp(pleat_model_joint_name(model, 0), "hips") == 0);

  pleat_pose* poses = malloc(num_frames * sizeof(pleat_pose));
  for (size_t t = 0; t < num_frames; ++t) {
    const double* values = pose_values + values_per_pose * t;
    memcpy(poses[t].root_position, values, sizeof(poses[t].root_position));
    poses[t].rotations = values + 3;
    poses[t].num_joints = num_joints;
  }
  pleat_evaluator* evaluator = NULL;
  EXPECT_OK(pleat_evaluator_create(model, &evaluator, &error));
  EXPECT_OK(pleat_evaluator_reserve(evaluator, 1, &error));
  pleat_model_destroy(model); /* the evaluator keeps what it needs */
  CHECK(heap.num_blocks > 0);

  Vertex* vertices = malloc(num_vertices * sizeof(Vertex));
  const size_t allocations_before = heap.num_allocations;
  for (size_t t = 0; t < num_frames; ++t) {
    const pleat_pose history[2] = {poses[t], poses[t > 0 ? t - 1 : 0]};
    pleat_query query = {.struct_size = sizeof(query), .poses = history, .num_poses = 2};
    query.positions.data = vertices[0].position;
    query.positions.stride = sizeof(Vertex);
    query.positions.num_bytes = num_vertices * sizeof(Vertex);
    query.normals.data = vertices[0].normal;
    query.normals.stride = sizeof(Vertex);
    query.normals.num_bytes = num_vertices * sizeof(Vertex) - offsetof(Vertex, normal);
    EXPECT_OK(pleat_evaluate(evaluator, &query, 1, &error));
    for (size_t v = 0; v < num_vertices; ++v) {
      const float* expected = frames + 3 * (t * num_vertices + v);
      const float* n = vertices[v].normal;
      CHECK(memcmp(vertices[v].position, expected, 3 * sizeof(float)) == 0);
      CHECK(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > .999f);
    }
  }
  CHECK(heap.num_allocations == allocations_before);

  /* Mistakes are errors with words. */
  CHECK(pleat_set_allocator(&allocator, &error) == PLEAT_FAILED_PRECONDITION);
  CHECK(pleat_model_create("no model", 8, NULL, &model, &error) == PLEAT_INVALID_ARGUMENT);
  CHECK(model == NULL && strstr(error.message, "model file") != NULL);

  pleat_evaluator_destroy(evaluator);
  CHECK(heap.num_blocks == 0);
  free(vertices);
  free(poses);
  free(frames);
  free(pose_values);
  printf("%u frames of %u vertices are equal to our own\n", (unsigned)num_frames,
         (unsigned)num_vertices);
  return 0;
}
