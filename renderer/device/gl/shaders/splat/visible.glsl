// Depths that fragments are tested by: those that the nearest pass left, and those behind which a silhouette hides
// everything. Where there is none, an order's bits are at or above infinity's. Variants: KEYS64, SILHOUETTE 0 or 1.
const uint infiniteOrder = 0x7f800000u;

#if REDUCTION != REDUCTION_NEAREST
#include "visible_order.glsl"
#endif

#if SILHOUETTE
layout(binding = 4) uniform usamplerBuffer silhouette;
uint silhouetteOrder(uint pixel) { return texelFetch(silhouette, int(pixel)).x; }
#endif
