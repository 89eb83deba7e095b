// The keys order << 32 | payload that nearest and cell passes keep the smallest of, pixel by pixel. In one dispatch where
// the driver has 64-bit atomics (KEEP_KEY); elsewhere in two (docs/spec/passes.md section 3.1): KEEP_ORDER keeps the smallest order,
// then in KEEP_PAYLOAD the fragments whose recomputed order equals it compete with their payload. Every value that decides
// is `precise`, so that both dispatches compute the same bits. Variants: KEEP, LOOK_FIRST (most fragments lose: where a
// look is cheaper than an atomic, it spares them one).
#if KEEP == KEEP_KEY
layout(std430, binding = 4) buffer Keys { uint64_t keys[]; };

void keep(uint pixel, float order, uint payload) {
    uint64_t key = packUint2x32(uvec2(payload, floatBitsToUint(order)));
#if LOOK_FIRST
    if (key >= keys[pixel]) return;
#endif
    atomicMin(keys[pixel], key);
}
#else
#if KEEP == KEEP_ORDER
layout(std430, binding = 4) buffer Orders { uint orders[]; };
#else
layout(binding = 1) uniform usamplerBuffer orders;
layout(std430, binding = 5) buffer Payloads { uint payloads[]; };
#endif

void keep(uint pixel, float order, uint payload) {
    uint bits = floatBitsToUint(order);
#if KEEP == KEEP_ORDER
#if LOOK_FIRST
    if (bits >= orders[pixel]) return;
#endif
    atomicMin(orders[pixel], bits);
#else
    if (bits != texelFetch(orders, int(pixel)).x) return;
#if LOOK_FIRST
    if (payload >= payloads[pixel]) return;
#endif
    atomicMin(payloads[pixel], payload);
#endif
}
#endif

// 8 bits of the squared distance to the centre, above the colour; nothing above an ordinal or a surface, which take all 32.
uint payloadOf(float distance2, float scale, uint color) {
#if PAYLOAD != PAYLOAD_COLOR
    return color;
#else
    precise float distance = distance2 * scale;
    return uint(min(distance, 255.0)) << 24 | color;
#endif
}
