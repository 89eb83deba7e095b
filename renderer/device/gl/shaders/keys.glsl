// The keys order << 32 | payload that nearest and cell passes keep the smallest of, pixel by pixel. In one dispatch where
// the driver has 64-bit atomics (KEEP_KEY); elsewhere in two (methods.md section 2): KEEP_ORDER keeps the smallest order,
// then in KEEP_PAYLOAD the fragments whose recomputed order equals it compete with their payload. Every value that decides
// is `precise`, so that both dispatches compute the same bits. Variant: KEEP.
#if KEEP == KEEP_KEY
layout(std430, binding = 4) buffer Keys { uint64_t keys[]; };

// Most fragments lose; looking first spares them the atomic.
void keep(uint pixel, float order, uint payload) {
    uint64_t key = packUint2x32(uvec2(payload, floatBitsToUint(order)));
    if (key < keys[pixel]) atomicMin(keys[pixel], key);
}
#else
layout(std430, binding = 4) buffer Orders { uint orders[]; };
layout(std430, binding = 5) buffer Payloads { uint payloads[]; };

void keep(uint pixel, float order, uint payload) {
    uint bits = floatBitsToUint(order);
#if KEEP == KEEP_ORDER
    if (bits < orders[pixel]) atomicMin(orders[pixel], bits);
#else
    if (bits == orders[pixel] && payload < payloads[pixel]) atomicMin(payloads[pixel], payload);
#endif
}
#endif

// 8 bits of the squared distance to the centre, above the colour; nothing above an ordinal, which takes all 32.
uint payloadOf(float distance2, float scale, uint color) {
#if PAYLOAD_SAMPLE
    return color;
#else
    precise float distance = distance2 * scale;
    return uint(min(distance, 255.0)) << 24 | color;
#endif
}
