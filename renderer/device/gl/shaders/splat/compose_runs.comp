// The numbers of a cut's runs as seen from somewhere, one thread a run: node -> view -> picture, in double, sum by sum what the
// host computes (composeToPicture() of device/host/splats.cpp). No vector is indexed by a number that only the GPU knows.
#version 450 core
#include "layouts_splat.glsl"
#include "layouts_runs.glsl"

layout(local_size_x = 64) in;

layout(std140, binding = 0) uniform Params { ComposeParams pass; };
layout(std430, binding = 0) readonly buffer Facts { RunFacts facts[]; };
layout(std430, binding = 1) writeonly buffer Runs { RunParams runs[]; };

const double largestFactor = 1e30lf;

bool fits(dvec3 values) { return all(lessThan(abs(values), dvec3(pass.scale.w))); }

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= pass.count.x) return;
    RunFacts known = facts[i];
    dvec3 acrossOf = pass.columns[0].xyz, upOf = pass.columns[1].xyz, towardsOf = pass.columns[2].xyz;
    precise dvec3 cornerSeen = (acrossOf * known.corner.x + upOf * known.corner.y) +
                               (towardsOf * known.corner.z + pass.columns[3].xyz);
    precise dvec3 x = pass.scale.xyz * (acrossOf * known.corner.w);
    precise dvec3 y = pass.scale.xyz * (upOf * known.steps.x);
    precise dvec3 z = pass.scale.xyz * (towardsOf * known.steps.y);
    precise dvec3 corner = pass.scale.xyz * cornerSeen;
    precise dvec4 sizes = 2.0lf * double(known.factors.w) * pass.sizes * pass.scale.x;

    RunParams run;
    run.toPicture[0] = vec4(x.x, y.x, z.x, corner.x);
    run.toPicture[1] = vec4(x.y, y.y, z.y, corner.y);
    run.toPicture[2] = vec4(x.z, y.z, z.z, corner.z);
    // Behind the eye, where nothing is drawn.
    if (!(fits(x) && fits(y) && fits(z) && fits(corner)))
        run.toPicture = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0, 0.0, 0.0, -1.0));
    run.clipMin = known.clipMin;
    run.clipMax = known.clipMax;
    run.sizeFactors = vec4(clamp(sizes, dvec4(0.0lf), dvec4(largestFactor)));
    run.factors = known.factors;
    run.color = known.color;
    runs[i] = run;
}
