/* The few things of GDNative that pleat_godot.c needs, for Godot 3.2 and later of its line, on
 * 64-bit machines. Godot gives a plug-in one table of functions whose order has not changed
 * since 3.0; a function is taken from it by its place. Values are opaque here, as they are in
 * Godot's own header gdnative.h. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

typedef struct GodotVariant {
  uint64_t opaque[3];
} GodotVariant;
typedef struct GodotArray {
  void* opaque;
} GodotArray;
typedef struct GodotPool { /* bytes, integers or vectors */
  void* opaque;
} GodotPool;
typedef struct GodotString {
  void* opaque;
} GodotString;

typedef struct GodotApi {
  unsigned int type; /* 0: the core */
  struct {
    unsigned int major, minor;
  } version;
  const void* next;
  unsigned int num_extensions;
  const void** extensions;
  void (*functions[744])(void);
} GodotApi;

typedef struct GodotInitOptions {
  bool in_editor;
  uint64_t core_api_hash, editor_api_hash, no_api_hash;
  void (*report_version_mismatch)(const void* library, const char* what, uint64_t want,
                                  uint64_t have);
  void (*report_loading_error)(const void* library, const char* what);
  void* library;
  const GodotApi* api;
  const void* active_library_path;
} GodotInitOptions;

extern const GodotApi* godot;

/* GODOT_CALL(place, result type, (parameter types), arguments...) */
#define GODOT_CALL(place, result, parameters, ...) \
  (((result(*) parameters)godot->functions[place])(__VA_ARGS__))

/* Arguments of a call, and results. */
static inline GodotVariant ArrayGet(const GodotArray* array, int place) {
  return GODOT_CALL(333, GodotVariant, (const GodotArray*, int), array, place);
}
static inline int ArraySize(const GodotArray* array) {
  return GODOT_CALL(356, int, (const GodotArray*), array);
}
static inline int64_t VariantAsInt(const GodotVariant* variant) {
  return GODOT_CALL(539, int64_t, (const GodotVariant*), variant);
}
static inline double VariantAsReal(const GodotVariant* variant) {
  return GODOT_CALL(540, double, (const GodotVariant*), variant);
}
static inline GodotPool VariantAsBytes(const GodotVariant* variant) {
  return GODOT_CALL(557, GodotPool, (const GodotVariant*), variant);
}
static inline void VariantDestroy(GodotVariant* variant) {
  GODOT_CALL(570, void, (GodotVariant*), variant);
}
static inline GodotVariant NewInt(int64_t value) {
  GodotVariant variant;
  GODOT_CALL(512, void, (GodotVariant*, int64_t), &variant, value);
  return variant;
}
static inline GodotVariant NewReal(double value) {
  GodotVariant variant;
  GODOT_CALL(513, void, (GodotVariant*, double), &variant, value);
  return variant;
}
static inline GodotVariant NewText(const char* text) {
  GodotVariant variant;
  GodotString string;
  GODOT_CALL(574, void, (GodotString*), &string);
  GODOT_CALL(679, bool, (GodotString*, const char*), &string, text);
  GODOT_CALL(514, void, (GodotVariant*, const GodotString*), &variant, &string);
  GODOT_CALL(721, void, (GodotString*), &string);
  return variant;
}

/* The bytes of a PoolByteArray, read through `access`, which ends with EndRead. */
static inline const uint8_t* BeginRead(const GodotPool* bytes, void** access) {
  *access = GODOT_CALL(165, void*, (const GodotPool*), bytes);
  return GODOT_CALL(268, const uint8_t*, (const void*), *access);
}
static inline void EndRead(void* access) { GODOT_CALL(270, void, (void*), access); }
static inline int NumBytes(const GodotPool* bytes) {
  return GODOT_CALL(169, int, (const GodotPool*), bytes);
}
static inline void DestroyBytes(GodotPool* bytes) { GODOT_CALL(170, void, (GodotPool*), bytes); }

/* A new PoolVector3Array of `size` vectors, written through `access`; FinishVectors makes the
 * result. A vector is three float32. */
static inline float* BeginVectors(GodotPool* vectors, int size, void** access) {
  GODOT_CALL(235, void, (GodotPool*), vectors);
  GODOT_CALL(244, void, (GodotPool*, int), vectors, size);
  *access = GODOT_CALL(246, void*, (GodotPool*), vectors);
  return GODOT_CALL(316, float*, (const void*), *access);
}
static inline GodotVariant FinishVectors(GodotPool* vectors, void* access) {
  GodotVariant variant;
  GODOT_CALL(318, void, (void*), access);
  GODOT_CALL(535, void, (GodotVariant*, const GodotPool*), &variant, vectors);
  GODOT_CALL(250, void, (GodotPool*), vectors);
  return variant;
}
/* The same for a PoolIntArray of 32-bit integers. */
static inline int32_t* BeginInts(GodotPool* ints, int size, void** access) {
  GODOT_CALL(171, void, (GodotPool*), ints);
  GODOT_CALL(180, void, (GodotPool*, int), ints, size);
  *access = GODOT_CALL(182, void*, (GodotPool*), ints);
  return GODOT_CALL(300, int32_t*, (const void*), *access);
}
static inline GodotVariant FinishInts(GodotPool* ints, void* access) {
  GodotVariant variant;
  GODOT_CALL(302, void, (void*), access);
  GODOT_CALL(531, void, (GodotVariant*, const GodotPool*), &variant, ints);
  GODOT_CALL(186, void, (GodotPool*), ints);
  return variant;
}
