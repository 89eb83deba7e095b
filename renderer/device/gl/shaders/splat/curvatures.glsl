// Curvatures of samples (renderer/cloud/curvature.hpp), as many in a page as samples. Needs RunParams.
layout(binding = 5) uniform usamplerBuffer curvatures;

// Of the sample at this place in its page; 0 where nobody knows.
uint curvatureAt(RunParams run, int at) { return (run.color.w & 2u) != 0u ? texelFetch(curvatures, at).x : 0u; }
