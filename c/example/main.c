/* Plays a pack through the C interface, and prints a hash of every thirtieth pose. Bare metal: startup.c is all there is below. */
#include "kinesic.h"

extern const uint8_t pack[], pack_end[];
void print(const char *text);
void leave(int code) __attribute__((noreturn));

static KinesicTranslator model;
static KinesicTranslatorState state;
static KinesicPose source, styled;

/* A stride a second: thighs (1, 5) and upper arms (13, 16) swing about the axis to the left. */
static void read_pose(uint32_t frame)
{
    float phase = (float)(frame % 60) / 60.0f;
    float swing = phase < 0.5f ? 4.0f * phase - 1.0f : 3.0f - 4.0f * phase;
    const int joints[4] = {1, 5, 13, 16};
    kinesic_pose_rest(&source);
    source.root[1] = 0.95f;
    source.root[2] = (float)frame / 60.0f;
    for (int i = 0; i < 4; i++) {
        float half = (i == 0 || i == 3 ? -0.2f : 0.2f) * swing;
        source.rotations[joints[i]][0] = half;
        source.rotations[joints[i]][3] = __builtin_sqrtf(1.0f - half * half);
    }
}

/* FNV-1a over the words of the first 19 joints. */
static uint32_t hash(const KinesicPose *pose)
{
    uint32_t value = 2166136261u;
    const uint32_t *words = (const uint32_t *)pose;
    for (int i = 0; i < 3 + 4 * 19; i++)
        value = (value ^ words[i]) * 16777619u;
    return value;
}

static void report(uint32_t frame, uint32_t value)
{
    char text[] = "frame 000: 00000000\n";
    for (int i = 0; i < 3; i++, frame /= 10)
        text[8 - i] = (char)('0' + frame % 10);
    for (int i = 0; i < 8; i++, value >>= 4)
        text[18 - i] = "0123456789abcdef"[value & 15];
    print(text);
}

int main(void)
{
    KinesicStatus status = kinesic_translator_load(&model, pack, (size_t)(pack_end - pack));
    if (status != KINESIC_STATUS_OK || kinesic_frame_rate(pack, (size_t)(pack_end - pack)) != 60.0f) {
        print("the pack is refused\n");
        leave(1);
    }
    /* One byte less must be refused. */
    if (kinesic_translator_load(&model, pack, (size_t)(pack_end - pack) - 1) != KINESIC_STATUS_DAMAGED) {
        print("a truncated pack is taken\n");
        leave(2);
    }
    kinesic_translator_state(&state);
    kinesic_translator_set_strength(&state, 0.8f);
    kinesic_translator_set_weight(&model, &state, 12, 0.5f);
    kinesic_pose_rest(&styled);
    read_pose(0);
    kinesic_translator_start(&model, &state, &source);
    for (uint32_t frame = 0; frame < 180; frame++) {
        read_pose(frame);
        /* A frame that is garbled, and four that do not come: the filters never see them, what was shown last is held. */
        if (frame == 89)
            source.rotations[5][3] = __builtin_nanf("");
        const KinesicPose *came = frame >= 118 && frame < 122 ? 0 : &source;
        kinesic_translator_step(&model, &state, came, &styled);
        if (frame % 30 == 29)
            report(frame, hash(&styled));
    }
    leave(0);
}
