// Directions in a surface, as kernels/surfel_codes.hpp decodes them. Needs exact.glsl and splat_tables.glsl.

// Of a unit normal in cloud space, one unit long: Frisvad's frame, turned by one of 32 angles.
vec3 axisAt(vec3 n, uint angle) {
    float cosine = uintBitsToFloat(tables[axisWords + angle]), sine = uintBitsToFloat(tables[axisWords + 32u + angle]);
    precise float across = n.x * n.x + n.y * n.y;
    bool down = n.z < 0.0, pole = down && across == 0.0;
    precise float above = down ? 1.0 - n.z : 1.0;
    precise float below = down ? across : 1.0 + n.z;
    float a = quotient(above, pole ? 1.0 : below);
    precise float b = -n.x * n.y * a;
    precise float firstX = pole ? 0.0 : 1.0 - n.x * n.x * a, secondY = pole ? 0.0 : 1.0 - n.y * n.y * a;
    float firstY = pole ? -1.0 : b, secondX = pole ? -1.0 : b;
    precise float x = firstX * cosine + secondX * sine;
    precise float y = firstY * cosine + secondY * sine;
    precise float z = -(n.x * cosine + n.y * sine);
    return vec3(x, y, pole ? 0.0 : z);
}
