// The keys that resolving turns into pixels: those of the cells where there are any, else the nearest's.
// Variant: KEYS64.
const uint infiniteOrder = 0x7f800000u;  // an order at or above it means "nothing here"

layout(binding = 1) uniform usamplerBuffer keys;
#if KEYS64
uint keyOrder(uint pixel) { return texelFetch(keys, int(pixel)).y; }
uint keyPayload(uint pixel) { return texelFetch(keys, int(pixel)).x; }
#else
layout(binding = 2) uniform usamplerBuffer payloads;
uint keyOrder(uint pixel) { return texelFetch(keys, int(pixel)).x; }
uint keyPayload(uint pixel) { return texelFetch(payloads, int(pixel)).x; }
#endif
