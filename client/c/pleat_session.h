/* Live sessions with a Pleat server: poses go out, frames come back in the same order
 * (docs/live_sessions.md). In the library libpleat, which has everything of pleat.h too.
 *
 * Threads: sending may run on one thread while receiving runs on another. Neither may run while the
 * session is destroyed. */
#pragma once

#include "pleat.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the server sends for a pose. */
enum {
  /* The mesh, as differences between frames: a few kilobytes, exact to half a step of the grid. */
  PLEAT_CONTENT_MESH = 0,
  /* Pose and detail coefficients, under a kilobyte. The library downloads the model once, when the
   * session opens, and evaluates it here. */
  PLEAT_CONTENT_PARAMETERS = 1
};

typedef struct pleat_session_options {
  size_t struct_size;
  const char* address;  /* HOST:PORT, or unix:PATH */
  const char* model_id; /* 64 hexadecimal digits */
  const char* token;    /* NULL: none */
  /* TLS is used when this is not NULL: the certificates that are trusted, PEM; "": the system's. */
  const char* tls_root_certificates;
  double connect_seconds;    /* the time after which opening gives up; 0: 5 */
  const double* bone_scales; /* as in pleat_query, num_bone_scales factors; NULL: none */
  size_t num_bone_scales;
  uint32_t content;        /* PLEAT_CONTENT_... */
  uint32_t position_bits;  /* of a mesh, 8 to 20; 0: 12, which is about half a millimeter */
  uint32_t max_in_flight;  /* poses that may be under way without an answer, 1 to 64; 0: 4 */
  uint32_t latest_wins;    /* not 0: a pose that waits is replaced by a newer one */
  uint32_t skinned_only;   /* not 0: without the learned detail */
  uint32_t max_reconnects; /* attempts in a row after the connection has ended; 0: 5 */
} pleat_session_options;

typedef struct pleat_session pleat_session;

/* Connects and starts the session. PLEAT_UNAVAILABLE when no server answers in time,
 * PLEAT_UNIMPLEMENTED when it is no Pleat server or one of another version, PLEAT_NOT_FOUND when it
 * does not have the model. */
PLEAT_API pleat_code pleat_session_open(const pleat_session_options* options,
                                        pleat_session** session, pleat_error* error);
/* Ends the session and waits for no more answers. */
PLEAT_API void pleat_session_destroy(pleat_session* session);

/* The number of vertices of every frame; 0 where there is no session. */
PLEAT_API uint32_t pleat_session_num_vertices(const pleat_session* session);

enum {
  PLEAT_SEND_RESTART = 1, /* forgets the poses sent before, after a cut */
  PLEAT_SEND_KEYFRAME = 2 /* asks for a frame that is no difference, after PLEAT_DATA_LOSS */
};

/* Sends a pose; `number` comes back with its frame. Waits while max_in_flight poses have no answer
 * (except with latest_wins), and while the session connects again. PLEAT_UNAVAILABLE when it has
 * ended; receiving says why. The poses sent before are the history, one interval of the training
 * apart. */
PLEAT_API pleat_code pleat_session_send(pleat_session* session, uint64_t number,
                                        const pleat_pose* pose, uint32_t flags, pleat_error* error);
/* The same with a history of its own: poses[0] is shown, poses[h] is the pose h intervals of the
 * training earlier, at most 8 in all. Later poses go on from these. For an editor, whose timeline
 * jumps. */
PLEAT_API pleat_code pleat_session_send_poses(pleat_session* session, uint64_t number,
                                              const pleat_pose* poses, size_t num_poses,
                                              uint32_t flags, pleat_error* error);
/* Says that no pose will follow. */
PLEAT_API void pleat_session_send_done(pleat_session* session);

typedef struct pleat_frame {
  size_t struct_size;
  pleat_rows positions;    /* written; `data` NULL: not wanted */
  uint64_t number;         /* written: of the pose */
  double confidence;       /* written */
  uint32_t num_superseded; /* written: poses before this one that get no frame */
  uint32_t resumed;        /* written: the first frame after a new connection */
  uint32_t queue_us;       /* written: from the arrival of the pose to its evaluation */
  uint32_t evaluate_us;    /* written */
  uint32_t encode_us;      /* written */
} pleat_frame;

/* Waits for the next answer. An error means one of two things. When pleat_session_ended(), it is
 * the end, and PLEAT_OUT_OF_RANGE is the regular one, after pleat_session_send_done(). Otherwise it
 * concerns the pose frame->number alone and the session goes on: the server cannot show the pose,
 * or the frame does not decode (PLEAT_DATA_LOSS; ask for a key frame then). */
PLEAT_API pleat_code pleat_session_receive(pleat_session* session, pleat_frame* frame,
                                           pleat_error* error);
PLEAT_API int pleat_session_ended(const pleat_session* session);

#ifdef __cplusplus
} /* extern "C" */
#endif
