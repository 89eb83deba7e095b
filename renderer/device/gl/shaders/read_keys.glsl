// The keys that resolving turns into pixels: those of the cells where there are any, else the nearest's.
// Variant: KEYS64.
const uint infiniteOrder = 0x7f800000u;  // an order at or above it means "nothing here"

#if KEYS64
layout(std430, binding = 4) readonly buffer Keys { uvec2 keys[]; };
uint keyOrder(uint pixel) { return keys[pixel].y; }
uint keyPayload(uint pixel) { return keys[pixel].x; }
#else
layout(std430, binding = 4) readonly buffer Orders { uint orders[]; };
layout(std430, binding = 5) readonly buffer Payloads { uint payloads[]; };
uint keyOrder(uint pixel) { return orders[pixel]; }
uint keyPayload(uint pixel) { return payloads[pixel]; }
#endif
