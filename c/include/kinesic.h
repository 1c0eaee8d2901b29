/* kinesic: learned motion style on a microcontroller. Made by `./ci.sh header` from c/src; do not edit.
 *
 * Everything is the caller's: there is no heap and no hidden state. A model borrows the pack's bytes, which must stay where they
 * are, aligned to 16. After a successful load nothing can fail. */

#ifndef KINESIC_H
#define KINESIC_H

#include <stddef.h>
#include <stdint.h>

/**
 * Joints that a pose holds; a pack with more is refused.
 */
#define KINESIC_JOINTS 32

/**
 * Rows of coordinates, three to a row: that of the root, and one per joint.
 */
#define KINESIC_ROWS 33

/**
 * Filter states of a translator, and its principal coordinates.
 */
#define KINESIC_STATES 1280

/**
 * Style components.
 */
#define KINESIC_COMPONENTS 64

/**
 * Units of the hidden layer and the code of body mechanics together.
 */
#define KINESIC_UNITS 600

/**
 * Frames of memory of body mechanics: a third of the frame rate.
 */
#define KINESIC_WINDOW 20

/**
 * What a load says.
 */
typedef enum {
  /**
   * The model may be stepped for ever.
   */
  KINESIC_STATUS_OK = 0,
  /**
   * A pointer is null.
   */
  KINESIC_STATUS_NULL = 1,
  /**
   * Fewer bytes than a header.
   */
  KINESIC_STATUS_TOO_SHORT = 2,
  /**
   * The bytes do not start at an address divisible by 16.
   */
  KINESIC_STATUS_MISALIGNED = 3,
  /**
   * No pack at all.
   */
  KINESIC_STATUS_NOT_A_PACK = 4,
  /**
   * A version or a kind of pack that this library does not know.
   */
  KINESIC_STATUS_VERSION = 5,
  /**
   * The lengths do not add up, or the checksum does not match: truncated or damaged.
   */
  KINESIC_STATUS_DAMAGED = 6,
  /**
   * The contents contradict themselves: a tensor is missing, has another shape, or holds what it must not.
   */
  KINESIC_STATUS_INVALID = 7,
  /**
   * The pack holds no model of this engine.
   */
  KINESIC_STATUS_NO_MODEL = 8,
  /**
   * The model is larger than KINESIC_JOINTS, KINESIC_STATES, ... allow.
   */
  KINESIC_STATUS_CAPACITY = 9,
} KinesicStatus;

/**
 * Loaded style components. They borrow the pack.
 */
typedef struct {
  size_t words[64];
} KinesicComponents;

/**
 * What running components remember.
 */
typedef struct {
  size_t words[344];
} KinesicComponentsState;

/**
 * A pose: local rotations and the root's position. Joints are in the pack's order (`kinesic inspect` prints it); those past the
 * pack's own are ignored. Metres, right-handed, Y up.
 */
typedef struct {
  /**
   * World position of the root, m.
   */
  float root[3];
  /**
   * Rotation of each joint relative to its parent: unit quaternions x, y, z, w.
   */
  float rotations[KINESIC_JOINTS][4];
} KinesicPose;

/**
 * Loaded body mechanics. They borrow the pack.
 */
typedef struct {
  size_t words[96];
} KinesicMechanics;

/**
 * What running body mechanics remember.
 */
typedef struct {
  size_t words[560];
} KinesicMechanicsState;

/**
 * The loaded engines of a pack: translator, style components and joint limits, in this order. They borrow the pack.
 */
typedef struct {
  size_t words[192];
} KinesicPipeline;

/**
 * What a running pipeline remembers.
 */
typedef struct {
  size_t words[3200];
} KinesicPipelineState;

/**
 * A loaded translator. It borrows the pack.
 */
typedef struct {
  size_t words[96];
} KinesicTranslator;

/**
 * What a running translator remembers: all the RAM that there is.
 */
typedef struct {
  size_t words[1616];
} KinesicTranslatorState;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Loads the style components of a pack, with every check that makes stepping infallible.
 *
 * # Safety
 * `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
 */
KinesicStatus kinesic_components_load(KinesicComponents *model,
                                      const uint8_t *pack,
                                      size_t len);

/**
 * Makes a new state: at the origin, facing +Z, strength 1, all joints.
 *
 * # Safety
 * `state` is null or valid.
 */
void kinesic_components_state(KinesicComponentsState *state);

/**
 * Restyles one live frame: `source` in, `styled` out. A null or garbled `source` is a frame that did not come: the last one is held.
 * `styled` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
 *
 * # Safety
 * `model` was loaded, `state` was made, the poses are valid; or null.
 */
void kinesic_components_step(const KinesicComponents *model,
                             KinesicComponentsState *state,
                             const KinesicPose *source,
                             KinesicPose *styled);

/**
 * Plays the next frame of the stored motion; after the last frame the first.
 *
 * # Safety
 * `model` was loaded, `state` was made, the pose is valid; or null.
 */
void kinesic_components_step_stored(const KinesicComponents *model,
                                    KinesicComponentsState *state,
                                    KinesicPose *styled);

/**
 * Strength from now on: 0 = the source, 1 = as learned, beyond = exaggerated.
 *
 * # Safety
 * `state` was made, or is null.
 */
void kinesic_components_set_strength(KinesicComponentsState *state, float strength);

/**
 * Weight of a joint from now on: 0 = untouched, 1 = restyled. A joint that the pack does not have is ignored.
 *
 * # Safety
 * `model` was loaded, `state` was made; or null.
 */
void kinesic_components_set_weight(const KinesicComponents *model,
                                   KinesicComponentsState *state,
                                   size_t joint,
                                   float weight);

/**
 * Loads the body mechanics of a pack, with every check that makes stepping infallible.
 *
 * # Safety
 * `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
 */
KinesicStatus kinesic_mechanics_load(KinesicMechanics *model,
                                     const uint8_t *pack,
                                     size_t len);

/**
 * Makes a new state: nothing seen yet.
 *
 * # Safety
 * `state` is null or valid.
 */
void kinesic_mechanics_state(KinesicMechanicsState *state);

/**
 * One frame with more or less expression: `amount` 0 = none, 1 = as observed, 2 = twice. A null or garbled `source` is a frame that
 * did not come: the last one is held. `out` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
 *
 * # Safety
 * `model` was loaded, `state` was made, the poses are valid; or null.
 */
void kinesic_mechanics_modulate(const KinesicMechanics *model,
                                KinesicMechanicsState *state,
                                const KinesicPose *source,
                                float amount,
                                KinesicPose *out);

/**
 * Weight of a joint from now on: 0 = as observed, 1 = the whole amount. A joint past the capacity is ignored.
 *
 * # Safety
 * `state` was made, or is null.
 */
void kinesic_mechanics_set_weight(KinesicMechanicsState *state,
                                  size_t joint,
                                  float weight);

/**
 * Loads the engines of a pack, with every check that makes stepping infallible. A pack needs one of the three.
 *
 * # Safety
 * `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
 */
KinesicStatus kinesic_pipeline_load(KinesicPipeline *model,
                                    const uint8_t *pack,
                                    size_t len);

/**
 * Makes a new state: nothing seen yet, strengths 1, all joints; limits begin at rest.
 *
 * # Safety
 * `state` is null or valid.
 */
void kinesic_pipeline_state(KinesicPipelineState *state);

/**
 * Puts everything where it would be had this pose always been held.
 *
 * # Safety
 * `model` was loaded, `state` was made, `source` is valid; or null.
 */
void kinesic_pipeline_start(const KinesicPipeline *model,
                            KinesicPipelineState *state,
                            const KinesicPose *source);

/**
 * One frame: `source` in, `out` out. A null or garbled `source` is a frame that did not come: limits brake, hold and go to rest,
 * everything else is held. `out` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
 *
 * # Safety
 * `model` was loaded, `state` was made, the poses are valid; or null.
 */
void kinesic_pipeline_step(const KinesicPipeline *model,
                           KinesicPipelineState *state,
                           const KinesicPose *source,
                           KinesicPose *out);

/**
 * One frame of coordinates in order, rad or m: servo positions in and out, without any rotation. A null or garbled `source` is a
 * frame that did not come. `kinesic_pipeline_coordinates` says how many there are; those past the end of an array are left out.
 *
 * # Safety
 * `model` was loaded, `state` was made, `source` and `out` are valid for `len` floats; or null.
 */
void kinesic_pipeline_step_coordinates(const KinesicPipeline *model,
                                       KinesicPipelineState *state,
                                       const float *source,
                                       float *out,
                                       size_t len);

/**
 * Coordinates of a loaded pack, what rows leave free included; 0 for a null model.
 *
 * # Safety
 * `model` was loaded, or is null.
 */
size_t kinesic_pipeline_coordinates(const KinesicPipeline *model);

/**
 * How far the body may be carried over the ground from where the source stands, m: changed steps make another way, which counts in full up to
 * half the reach and then ever less. A loaded model has 4; infinity is as far as it gets.
 *
 * # Safety
 * `model` was loaded, or is null.
 */
void kinesic_pipeline_set_reach(KinesicPipeline *model,
                                float reach);

/**
 * Strength of translator and components from now on: 0 = the source, 1 = as learned, beyond = exaggerated.
 *
 * # Safety
 * `state` was made, or is null.
 */
void kinesic_pipeline_set_strength(KinesicPipelineState *state,
                                   float strength);

/**
 * Frames that did not come or were garbled since the last sound one; 0 for a null state.
 *
 * # Safety
 * `state` was made, or is null.
 */
uint32_t kinesic_pipeline_gap(const KinesicPipelineState *state);

/**
 * Makes the rest pose: all rotations the identity, the root at the origin.
 *
 * # Safety
 * `pose` is null or valid.
 */
void kinesic_pose_rest(KinesicPose *pose);

/**
 * Loads the translator of a pack, with every check that makes stepping infallible.
 *
 * # Safety
 * `pack` is null or valid for `len` bytes for as long as the model is used; `model` is null or valid.
 */
KinesicStatus kinesic_translator_load(KinesicTranslator *model,
                                      const uint8_t *pack,
                                      size_t len);

/**
 * Frames per second at which the pack must be stepped; 0 for bytes that are no pack.
 *
 * # Safety
 * `pack` is null or valid for `len` bytes.
 */
float kinesic_frame_rate(const uint8_t *pack, size_t len);

/**
 * Makes a new state: zero filters, strength 1, all joints.
 *
 * # Safety
 * `state` is null or valid.
 */
void kinesic_translator_state(KinesicTranslatorState *state);

/**
 * Initialises the filters to their steady state for this pose, so that the first half second does not ease in.
 *
 * # Safety
 * `model` was loaded, `state` was made, `source` is valid; or null.
 */
void kinesic_translator_start(const KinesicTranslator *model,
                              KinesicTranslatorState *state,
                              const KinesicPose *source);

/**
 * Translates one frame: `source` in, `styled` out. A null or garbled `source` is a frame that did not come: the last one is held.
 * `styled` is a pose of its own that keeps what went out before; `kinesic_pose_rest` makes the first.
 *
 * # Safety
 * `model` was loaded, `state` was made, the poses are valid; or null.
 */
void kinesic_translator_step(const KinesicTranslator *model,
                             KinesicTranslatorState *state,
                             const KinesicPose *source,
                             KinesicPose *styled);

/**
 * How far the body may be carried over the ground from where the source stands, m: changed steps make another way, which counts in full up to
 * half the reach and then ever less. A loaded model has 4; infinity is as far as it gets.
 *
 * # Safety
 * `model` was loaded, or is null.
 */
void kinesic_translator_set_reach(KinesicTranslator *model,
                                  float reach);

/**
 * Strength from now on: 0 = the source, 1 = as learned, beyond = exaggerated.
 *
 * # Safety
 * `state` was made, or is null.
 */
void kinesic_translator_set_strength(KinesicTranslatorState *state, float strength);

/**
 * Weight of a joint from now on: 0 = untouched, 1 = translated. A joint that the pack does not have is ignored.
 *
 * # Safety
 * `model` was loaded, `state` was made; or null.
 */
void kinesic_translator_set_weight(const KinesicTranslator *model,
                                   KinesicTranslatorState *state,
                                   size_t joint,
                                   float weight);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* KINESIC_H */
