// Depths that fragments are tested by: those that the nearest pass left, and those behind which a silhouette hides
// everything. Where there is none, an order's bits are at or above infinity's. Variants: KEYS64, SILHOUETTE 0 or 1.
const uint infiniteOrder = 0x7f800000u;

#if REDUCTION != REDUCTION_NEAREST
#if KEYS64
layout(std430, binding = 6) readonly buffer Visible { uvec2 visibleKeys[]; };
uint visibleOrder(uint pixel) { return visibleKeys[pixel].y; }
#else
layout(std430, binding = 6) readonly buffer Visible { uint visibleOrders[]; };
uint visibleOrder(uint pixel) { return visibleOrders[pixel]; }
#endif
#endif

#if SILHOUETTE
layout(std430, binding = 7) readonly buffer Silhouette { uint silhouetteOrders[]; };
#endif
