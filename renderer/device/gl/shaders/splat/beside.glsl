// What stands beside samples (renderer/cloud/beside.hpp), behind them in their page. Needs `samples` and RunParams.

const uint curvatureBits = 0x00ffffffu;

// The word of the page; 0 where there is none.
uint besideAt(RunParams run, uint word) {
    return (run.color.w & 2u) != 0u ? texelFetch(samples, int(word >> 2))[word & 3u] : 0u;
}
