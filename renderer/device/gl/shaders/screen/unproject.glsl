// From a pixel and its depth to a point relative to the eye, x right, y up; after pyramid.glsl.

// Of a pixel, per unit of depth in perspective.
vec2 rayOf(vec2 pixel) {
    precise float x = (pixel.x + (0.5 - pyramid.sight.x)) * pyramid.sight.z;
    precise float y = ((pyramid.sight.y - 0.5) - pixel.y) * pyramid.sight.z;
    return vec2(x, y);
}

// Depth, x, y, and in perspective the squared distance to the eye, else 1.
vec4 pointOf(vec2 pixel, float depth) {
    vec2 ray = rayOf(pixel);
    float scale = perspective() ? depth : 1.0;
    precise float x = ray.x * scale;
    precise float y = ray.y * scale;
    precise float square = x * x + y * y + depth * depth;
    return vec4(depth, x, y, perspective() ? square : 1.0);
}
