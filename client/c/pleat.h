/* Pleat in a game engine or in another language: a character from memory, frames into the caller's
 * buffers. docs/guide/game_engine.md is the guide.
 *
 * The library libpleat_eval has everything in this header; libpleat has it too, and sessions to a
 * server besides (pleat_session.h). Plain C11. Units are meters and seconds, Y points up.
 *
 * Errors. A function that can fail returns a pleat_code. When `error` is not NULL, it is filled:
 * the message says what is wrong, where, and what to do. NULL handles, short buffers and damaged
 * bytes are errors like others; nothing that a caller passes by value, and no content of a model,
 * ends the process. A pointer that is not NULL must point to what its comment says.
 *
 * Threads. A model never changes: any number of threads may use it. An evaluator or a motion serves
 * one thread at a time. Everything else may be called from anywhere.
 *
 * Memory. After pleat_evaluator_reserve(), evaluating allocates nothing.
 *
 * Versions. Symbols have the version PLEAT_1. Structs that may grow begin with `struct_size`, which
 * the caller sets to sizeof; a later library takes the size of an earlier header. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PLEAT_API __attribute__((visibility("default")))
#else
#define PLEAT_API
#endif

/* The interface that this header describes. It changes only when a caller must change. */
#define PLEAT_API_VERSION 1

/* What the library is: the interface that it has, and its release, "0.1.0". A caller that was built
 * with this header works with every library whose pleat_api_version() is PLEAT_API_VERSION. */
PLEAT_API uint32_t pleat_api_version(void);
PLEAT_API const char* pleat_version(void);

/* The numbers are those of gRPC's status codes. */
typedef int32_t pleat_code;
enum {
  PLEAT_OK = 0,
  PLEAT_CANCELLED = 1,
  PLEAT_UNKNOWN = 2,
  PLEAT_INVALID_ARGUMENT = 3, /* of this call, or of a file that it was given */
  PLEAT_DEADLINE_EXCEEDED = 4,
  PLEAT_NOT_FOUND = 5,
  PLEAT_PERMISSION_DENIED = 7,
  PLEAT_RESOURCE_EXHAUSTED = 8, /* a limit, or no memory */
  PLEAT_FAILED_PRECONDITION = 9,
  PLEAT_ABORTED = 10,
  PLEAT_OUT_OF_RANGE = 11, /* the regular end of a session */
  PLEAT_UNIMPLEMENTED = 12,
  PLEAT_INTERNAL = 13, /* a mistake of the library */
  PLEAT_UNAVAILABLE = 14,
  PLEAT_DATA_LOSS = 15, /* bytes that are cut off or corrupt */
  PLEAT_UNAUTHENTICATED = 16
};

/* What went wrong. The caller owns it; its size never changes. */
typedef struct pleat_error {
  pleat_code code;
  char message[1020]; /* UTF-8, ends with a zero; longer words are cut */
} pleat_error;

/* Where models and evaluators take the memory of their matrices and learned tables, which is most
 * of what they need (pleat_model_info.memory_bytes counts all of it). Lists of the mesh, names and
 * messages come from the C++ library as ever. Both functions must be safe to call from every thread
 * that uses the library. */
typedef struct pleat_allocator {
  size_t struct_size;
  void* user; /* passed back as it is */
  /* Returns `size` bytes at an address that is a multiple of `alignment`, a power of two, or NULL
   * when there is no memory; the call that needed it then fails with PLEAT_RESOURCE_EXHAUSTED. */
  void* (*allocate)(void* user, size_t size, size_t alignment);
  void (*deallocate)(void* user, void* memory); /* never NULL */
} pleat_allocator;

/* Sets the allocator of the whole library, once, before anything else is made. Afterwards it is
 * PLEAT_FAILED_PRECONDITION. */
PLEAT_API pleat_code pleat_set_allocator(const pleat_allocator* allocator, pleat_error* error);

/* Models ------------------------------------------------------------------------------------- */

typedef struct pleat_model pleat_model;

typedef struct pleat_model_options {
  size_t struct_size;
  /* The most that the model may take in memory beyond the size of the file; 0: 4 GiB. */
  uint64_t max_unfolded_bytes;
} pleat_model_options;

/* Reads a model file (.pleat) from memory; the bytes are copied and not needed afterwards. They may
 * come from anywhere: PLEAT_INVALID_ARGUMENT says that they are no model or of a version that this
 * library does not know, PLEAT_DATA_LOSS that they are damaged, PLEAT_RESOURCE_EXHAUSTED that they
 * are too large. options: NULL for the defaults. */
PLEAT_API pleat_code pleat_model_create(const void* bytes, size_t num_bytes,
                                        const pleat_model_options* options, pleat_model** model,
                                        pleat_error* error);
/* Evaluators and motions of the model stay valid. NULL is fine, as for all destroyers. */
PLEAT_API void pleat_model_destroy(pleat_model* model);

typedef struct pleat_model_info {
  size_t struct_size;
  uint32_t num_vertices; /* V, in the order of the mesh that the model was trained on */
  uint32_t num_faces, num_corners, num_triangles;
  uint32_t num_texcoords;    /* 0: the mesh had none */
  uint32_t num_joints;       /* J */
  uint32_t num_coefficients; /* of the learned detail */
  uint32_t history;          /* poses that a query looks at: the one to show and earlier ones */
  double frames_per_second;  /* of the training; earlier poses are 1 / frames_per_second apart */
  uint64_t memory_bytes;
} pleat_model_info;

PLEAT_API pleat_code pleat_model_get_info(const pleat_model* model, pleat_model_info* info,
                                          pleat_error* error);
/* Texts live as long as the model. NULL where there is no such model or joint. */
PLEAT_API const char* pleat_model_name(const pleat_model* model);
PLEAT_API const char* pleat_model_joint_name(const pleat_model* model, uint32_t joint);
/* Parents come before their children. -1: the root; -2: no such joint. */
PLEAT_API int32_t pleat_model_joint_parent(const pleat_model* model, uint32_t joint);
/* positions: 3 J, the joints in the rest pose. */
PLEAT_API pleat_code pleat_model_copy_joints(const pleat_model* model, double* positions,
                                             size_t num_values, pleat_error* error);
/* Lists of the mesh, copied whole; a count that is not the list's is an error. Triangles are the
 * fans of the faces: 3 indices each. Faces: corners of each face, and the vertex of each corner.
 * Texture coordinates: 2 each; corner_texcoords: the index of each corner's, -1 = none. */
PLEAT_API pleat_code pleat_model_copy_triangles(const pleat_model* model, uint32_t* indices,
                                                size_t num_values, pleat_error* error);
PLEAT_API pleat_code pleat_model_copy_face_sizes(const pleat_model* model, uint32_t* sizes,
                                                 size_t num_values, pleat_error* error);
PLEAT_API pleat_code pleat_model_copy_corners(const pleat_model* model, uint32_t* vertices,
                                              size_t num_values, pleat_error* error);
PLEAT_API pleat_code pleat_model_copy_texcoords(const pleat_model* model, float* texcoords,
                                                size_t num_values, pleat_error* error);
PLEAT_API pleat_code pleat_model_copy_corner_texcoords(const pleat_model* model, int32_t* indices,
                                                       size_t num_values, pleat_error* error);

/* What a package of its own needs to show the character without this library: its skin and what the
 * training has recorded. */

/* positions: 3 V, the mesh in the rest pose. */
PLEAT_API pleat_code pleat_model_copy_rest_positions(const pleat_model* model, float* positions,
                                                     size_t num_values, pleat_error* error);
/* The strongest `per_vertex` bones of every vertex, 1 to 8, the strongest first, with weights that
 * sum to 1; both lists have V * per_vertex values, and what is left over is bone 0 with weight 0.
 * Bone b ends in joint b and turns about the joint above it. */
PLEAT_API pleat_code pleat_model_copy_influences(const pleat_model* model, uint32_t per_vertex,
                                                 uint32_t* bones, float* weights, size_t num_values,
                                                 pleat_error* error);

/* Distances of vertices on the training frames, in % of the diagonal. */
typedef struct pleat_errors {
  double mean_percent;
  double rms_percent;
  double p95_percent; /* 95th percentile over all vertices of all frames */
  double max_percent;
  double mean_mm;
} pleat_errors;

typedef struct pleat_model_record {
  size_t struct_size;
  const char* learner; /* that the training has chosen; lives as long as the model */
  uint32_t num_frames;
  uint32_t num_warnings;
  double rig_residual; /* under .03 the rig can be trusted */
  double diagonal_m;
  pleat_errors skinned;  /* the rig alone */
  pleat_errors detailed; /* the whole model */
} pleat_model_record;

PLEAT_API pleat_code pleat_model_get_record(const pleat_model* model, pleat_model_record* record,
                                            pleat_error* error);
/* What the user should look at, in words; NULL where there is no such warning. */
PLEAT_API const char* pleat_model_warning(const pleat_model* model, uint32_t warning);

/* Poses -------------------------------------------------------------------------------------- */

/* One pose. Rotations are unit quaternions x, y, z, w, joint by joint in the model's order,
 * relative to the parent and written in the axes of the rest pose, in which all are 0, 0, 0, 1. The
 * rotation of joint 0 turns the character in the world; that of another joint turns the bone that
 * ends in it. */
typedef struct pleat_pose {
  double root_position[3]; /* of joint 0 in the world */
  const double* rotations; /* 4 J */
  size_t num_joints;       /* J, checked against the model's */
} pleat_pose;

/* The poses of a motion while it goes on, at any frame rate, a varying one included: it gives the
 * history that a query wants. A game pushes the pose of every frame. */
typedef struct pleat_motion pleat_motion;

PLEAT_API pleat_code pleat_motion_create(const pleat_model* model, pleat_motion** motion,
                                         pleat_error* error);
PLEAT_API void pleat_motion_destroy(pleat_motion* motion);
/* The seconds count from anywhere and must grow from pose to pose. */
PLEAT_API pleat_code pleat_motion_push(pleat_motion* motion, double seconds, const pleat_pose* pose,
                                       pleat_error* error);
/* Forgets all poses: after a cut or a teleport, which is no speed. */
PLEAT_API void pleat_motion_restart(pleat_motion* motion);
/* The newest pose and the earlier ones that the model looks at, for pleat_query.poses; valid until
 * the next call with this motion. PLEAT_FAILED_PRECONDITION before the first push. */
PLEAT_API pleat_code pleat_motion_poses(pleat_motion* motion, const pleat_pose** poses,
                                        size_t* num_poses, pleat_error* error);

/* Frames ------------------------------------------------------------------------------------- */

/* Three floats for each of the V vertices, `stride` bytes apart. */
typedef struct pleat_rows {
  float* data;      /* of vertex 0 */
  size_t stride;    /* a multiple of 4, at least 12; 0 means 12 */
  size_t num_bytes; /* from `data` to the end of the memory, checked: (V - 1) * stride + 12 */
} pleat_rows;

enum { PLEAT_SKINNED_ONLY = 1 }; /* flags of a query: leaves out the learned detail */

typedef struct pleat_query {
  size_t struct_size;
  /* poses[0] is shown; poses[h] is the pose h / frames_per_second earlier. When there are fewer
   * than the model looks at, the oldest is repeated. */
  const pleat_pose* poses;
  size_t num_poses;
  const double* bone_scales; /* J factors on the lengths of the bones, .05 to 20; NULL: all are 1 */
  pleat_rows positions;      /* written: world positions */
  pleat_rows normals;        /* written unless `data` is NULL: unit normals, weighted by area */
  double confidence;         /* written: 1 = like the poses of the training, 0 = unknown */
  pleat_code code;           /* written: whether this query was answered */
  uint32_t flags;
} pleat_query;

typedef struct pleat_evaluator pleat_evaluator;

PLEAT_API pleat_code pleat_evaluator_create(const pleat_model* model, pleat_evaluator** evaluator,
                                            pleat_error* error);
PLEAT_API void pleat_evaluator_destroy(pleat_evaluator* evaluator);
/* Takes all memory that queries in batches of up to max_queries need, 4096 at most. */
PLEAT_API pleat_code pleat_evaluator_reserve(pleat_evaluator* evaluator, size_t max_queries,
                                             pleat_error* error);
/* Answers all queries, in one pass over the model; every frame has the same bits as alone. A query
 * with an error does not stop the others and writes no frame. Returns the first error. All queries
 * must have the same struct_size. */
PLEAT_API pleat_code pleat_evaluate(pleat_evaluator* evaluator, pleat_query* queries,
                                    size_t num_queries, pleat_error* error);

/* Where on the body a pose is unlike the training. confidence: J values for the joints of poses[0],
 * 1 where a training frame has the joint as it is now, 0 where none is near. The poses are as in
 * pleat_query. For pictures: it is no part of an evaluation. */
PLEAT_API pleat_code pleat_joint_confidence(const pleat_model* model, const pleat_pose* poses,
                                            size_t num_poses, double* confidence, size_t num_joints,
                                            pleat_error* error);

/* Parameters of a stream --------------------------------------------------------------------- */

/* What somebody who has the model needs to show a frame: about a kilobyte in place of a mesh. They
 * are what a server's streams of the content PARAMETERS hold (FrameParameters of
 * proto/pleat/v1/pose_service.proto), and give the same bits on every machine. */
typedef struct pleat_parameters {
  size_t struct_size;
  double root_position[3];
  float* rotations;        /* 4 J: x, y, z, w as in pleat_pose (the wire has w first) */
  size_t num_joints;       /* J, checked */
  float* coefficients;     /* num_coefficients of the model */
  size_t num_coefficients; /* in pleat_show() 0 means: without the learned detail */
  double confidence;
} pleat_parameters;

/* The two halves of a query, for two machines. Predict reads poses and flags of the query and fills
 * the parameters, whose lists the caller provides with the sizes that the model has; with
 * PLEAT_SKINNED_ONLY it sets num_coefficients to 0. Show reads bone_scales of the query and writes
 * positions, normals, confidence and code; it does not look at the poses. */
PLEAT_API pleat_code pleat_predict(pleat_evaluator* evaluator, pleat_query* query,
                                   pleat_parameters* parameters, pleat_error* error);
PLEAT_API pleat_code pleat_show(pleat_evaluator* evaluator, const pleat_parameters* parameters,
                                pleat_query* query, pleat_error* error);

#ifdef __cplusplus
} /* extern "C" */
#endif
