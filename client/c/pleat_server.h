/* What a Pleat server does besides live sessions: takes are uploaded, characters are trained with
 * progress and downloaded (docs/guide/blender.md uses all of it). In the library libpleat.
 *
 * Threads: a server and a take may be used by any number of threads at once; neither may be in use
 * while it is destroyed. Functions of this header wait for the network or the disk: a program with
 * an interface calls them on a thread of their own. Functions of the caller are called on the
 * thread that made the call. */
#pragma once

#include "pleat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How far a call is: a stage, "upload" for example, and the share of all that is done, 0 to 1. A
 * result that is not 0 ends the call with PLEAT_CANCELLED. NULL is fine wherever one is taken. */
typedef int (*pleat_progress)(void* user, const char* stage, double fraction);

/* Takes -------------------------------------------------------------------------------------- */

/* A mesh animation: one connectivity, many frames. */
typedef struct pleat_take pleat_take;

typedef struct pleat_take_mesh {
  size_t struct_size;
  const char* name;           /* NULL: none */
  uint32_t num_vertices;      /* V */
  uint32_t num_frames;        /* T */
  const uint32_t* face_sizes; /* corners of each face, 3 or more */
  size_t num_faces;
  const uint32_t* corners; /* the vertex of each corner, face after face */
  size_t num_corners;
  int32_t rate_numerator; /* frames per second, as an exact fraction */
  int32_t rate_denominator;
} pleat_take_mesh;

/* Makes a take of the caller's arrays, which are copied. positions: T x V x 3, meters, Y up. */
PLEAT_API pleat_code pleat_take_create(const pleat_take_mesh* mesh, const float* positions,
                                       size_t num_values, pleat_take** take, pleat_error* error);
/* Reads a take from files: everything that `pleat` reads, but Draco. */
PLEAT_API pleat_code pleat_take_read(const char* path, pleat_progress progress, void* user,
                                     pleat_take** take, pleat_error* error);
/* Writes an Alembic archive (.abc) or a sequence file (.pseq), by the ending of the path. A file
 * that is there is replaced. */
PLEAT_API pleat_code pleat_take_write(const pleat_take* take, const char* path, pleat_error* error);
PLEAT_API void pleat_take_destroy(pleat_take* take);

typedef struct pleat_take_info {
  size_t struct_size;
  uint32_t num_vertices, num_faces, num_frames;
  int32_t rate_numerator, rate_denominator;
  uint32_t num_notes; /* what the reader left out or doubts */
} pleat_take_info;

PLEAT_API pleat_code pleat_take_get_info(const pleat_take* take, pleat_take_info* info,
                                         pleat_error* error);
PLEAT_API const char* pleat_take_name(const pleat_take* take);
PLEAT_API const char* pleat_take_note(const pleat_take* take, uint32_t note);

/* Servers ------------------------------------------------------------------------------------ */

typedef struct pleat_server pleat_server;

typedef struct pleat_server_options {
  size_t struct_size;
  const char* address; /* HOST:PORT, or unix:PATH */
  const char* token;   /* NULL: none */
  /* TLS is used when this is not NULL: the certificates that are trusted, PEM; "": the system's. */
  const char* tls_root_certificates;
  double connect_seconds; /* the time after which connecting gives up; 0: 5 */
} pleat_server_options;

/* Connects and asks the server what it is. PLEAT_UNAVAILABLE when nobody answers in time,
 * PLEAT_UNIMPLEMENTED when it is no Pleat server or one of another version. */
PLEAT_API pleat_code pleat_server_connect(const pleat_server_options* options,
                                          pleat_server** server, pleat_error* error);
PLEAT_API void pleat_server_destroy(pleat_server* server);

#define PLEAT_ID_SIZE 65 /* bytes of an id with its zero, of jobs too */

/* Uploads a take and writes its id; one that is there already is stored once. */
PLEAT_API pleat_code pleat_server_upload(pleat_server* server, const pleat_take* take,
                                         pleat_progress progress, void* user,
                                         char sequence_id[PLEAT_ID_SIZE], pleat_error* error);

typedef struct pleat_training {
  size_t struct_size;
  const char* const* sequence_ids; /* clips of one mesh */
  size_t num_sequences;
  const char* name;    /* of the model; NULL: that of the first clip */
  const char* options; /* lines NAME=VALUE with names of docs/options.md; NULL: all defaults */
} pleat_training;

/* Puts a training at the end of the server's queue and writes the id of the job. */
PLEAT_API pleat_code pleat_server_train(pleat_server* server, const pleat_training* training,
                                        char job_id[PLEAT_ID_SIZE], pleat_error* error);

enum {
  PLEAT_JOB_QUEUED = 0,
  PLEAT_JOB_RUNNING = 1,
  PLEAT_JOB_SUCCEEDED = 2,
  PLEAT_JOB_FAILED = 3,
  PLEAT_JOB_CANCELLED = 4
};

typedef struct pleat_job {
  size_t struct_size; /* set by the library when it calls the caller */
  uint32_t state;
  char stage[64];                /* of the running computation: "rig", "fit", "learn", ... */
  double fraction;               /* of the whole job, 0 to 1 */
  double eta_seconds;            /* until the end; below 0: not known */
  char result_id[PLEAT_ID_SIZE]; /* of the model, when it has succeeded */
} pleat_job;

/* Is called with the job now and after every change. A result that is not 0 ends the watching, and
 * the job goes on. */
typedef int (*pleat_job_observer)(void* user, const pleat_job* job);

/* Returns when the job is final, with it in `last`, which may be NULL. A job that has failed or was
 * cancelled is an error with the words of the server. */
PLEAT_API pleat_code pleat_server_watch(pleat_server* server, const char* job_id,
                                        pleat_job_observer observe, void* user, pleat_job* last,
                                        pleat_error* error);
PLEAT_API pleat_code pleat_server_cancel(pleat_server* server, const char* job_id,
                                         pleat_error* error);

typedef struct pleat_model_entry {
  size_t struct_size; /* set by the library */
  const char* id;     /* the texts are valid during the call */
  const char* name;
  const char* learner;
  uint32_t num_vertices;
  uint32_t num_joints;
  double frames_per_second;
  uint64_t size_bytes;
} pleat_model_entry;

/* Is called with every model of the server, the oldest first, until a result is not 0. */
typedef int (*pleat_model_visitor)(void* user, const pleat_model_entry* model);

PLEAT_API pleat_code pleat_server_list_models(pleat_server* server, pleat_model_visitor visit,
                                              void* user, pleat_error* error);

/* Downloads a model file and gives it to `take`, once, whole; the bytes are valid during the call.
 * pleat_model_create() reads them. */
typedef void (*pleat_bytes_taker)(void* user, const void* bytes, size_t num_bytes);

PLEAT_API pleat_code pleat_server_download(pleat_server* server, const char* model_id,
                                           pleat_progress progress, pleat_bytes_taker take,
                                           void* user, pleat_error* error);

#ifdef __cplusplus
} /* extern "C" */
#endif
