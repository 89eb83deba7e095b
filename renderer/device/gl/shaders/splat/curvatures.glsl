// Curvatures of samples (renderer/cloud/curvature.hpp), behind them in their page. Needs `samples` and RunParams.

// The word of the page; 0 where nobody knows.
uint curvatureAt(RunParams run, uint word) {
    return (run.color.w & 2u) != 0u ? texelFetch(samples, int(word >> 2))[word & 3u] : 0u;
}
