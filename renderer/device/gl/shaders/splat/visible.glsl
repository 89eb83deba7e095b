// Depths that fragments are tested by: those that the nearest pass left, and those behind which a silhouette hides
// everything. Where there is none, an order's bits are at or above infinity's. Variants: KEYS64, SILHOUETTE 0 or 1.
const uint infiniteOrder = 0x7f800000u;

#if REDUCTION != REDUCTION_NEAREST
#include "visible_order.glsl"

// What is visible there (formulas/constants.inl): payloads of the cells' keys where there are any, else of the nearest's.
layout(binding = 2) uniform usamplerBuffer surfaces;
uint surfaceThere(uint pixel) { return texelFetch(surfaces, int(pixel)).x; }
#endif

#if SILHOUETTE
layout(binding = 4) uniform usamplerBuffer silhouette;
uint silhouetteOrder(uint pixel) { return texelFetch(silhouette, int(pixel)).x; }
#endif
