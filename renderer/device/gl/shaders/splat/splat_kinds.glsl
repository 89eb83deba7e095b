// Kinds that shaders are specialised for, as plan/splat_kind.hpp and host/splat_numbers.hpp number them
// (splat_variants.cpp checks that).
#define SHAPE_FLAT_SQUARE 0
#define SHAPE_FLAT_CIRCLE 1
#define SHAPE_PARABOLOID_SQUARE 2
#define SHAPE_PARABOLOID_CIRCLE 3
#define SHAPE_CONE_SQUARE 4
#define SHAPE_CONE_CIRCLE 5
#define SHAPE_SPHERE_CIRCLE 6
#define SHAPE_DISC 7
#define SHAPE_ELLIPSE 8

#define COLOR_RGB 0
#define COLOR_PER_RUN 1
#define COLOR_INTENSITY 2
#define COLOR_ELEVATION 3
#define COLOR_CLASSIFICATION 4
#define COLOR_NORMAL 5
#define COLOR_DEPTH 6
#define COLOR_TONED 7
#define COLOR_CURVATURE 8
#define COLOR_INFRARED 9

#define REDUCTION_NEAREST 0
#define REDUCTION_CELL 1
#define REDUCTION_SUM 2

#define PAYLOAD_COLOR 0
#define PAYLOAD_SAMPLE 1
#define PAYLOAD_SURFACE 2
#define PAYLOAD_NONE 3

#define KEEP_ORDER 0
#define KEEP_PAYLOAD 1
#define KEEP_KEY 2

#define CHUNK_SAMPLES 1024
// Pixels of a footprint, from which on it is not for one thread alone.
#define MANY_PIXELS 256
