// What an independent program found in the real scans, as SOURCES.md (beside them) prints it.
#pragma once

#include <array>
#include <cstdint>
#include <ostream>

namespace scancast::test {

struct RealScan {
    const char* file;
    const char* format;
    std::uint64_t points;          ///< declared
    std::uint64_t dropped;         ///< NaN, and in PTX no echo
    const char* columns;           ///< c colour, i intensity, k classification, n normal
    const char* box;               ///< "size x y z; min x y z", rounded as printed
    std::array<int, 2> intensity;  ///< {-1, -1} = scaled, not compared
    const char* classes;
    int rgbMax;  ///< as stored, -1 = none
};

/// What a test's name shows of it.
inline void PrintTo(const RealScan& scan, std::ostream* out) {
    *out << scan.file;
}

// clang-format off
inline const RealScan realScans[] = {
    {"ply/3dmatch-cloud_bin_0.ply", "PLY, binary little-endian", 258342, 0, "",
     "2.844 x 2.136 x 2.694; min -1.350 -1.446 0.800", {-1, -1}, "", -1},
    {"ply/bun_zipper.ply", "PLY, ascii", 35947, 0, "i",
     "0.156 x 0.154 x 0.121; min -0.095 0.033 -0.062", {-1, -1}, "", -1},
    {"ply/bunny-tristrips.ply", "PLY, binary little-endian", 34834, 0, "",
     "0.156 x 0.154 x 0.121; min -0.095 0.033 -0.062", {-1, -1}, "", -1},
    {"ply/cgal-b9_training.ply", "PLY, binary little-endian", 22300, 0, "ck",
     "90.875 x 111.97 x 23.684; min 596648.06 243620.02 73.502", {-1, -1}, "", -1},
    {"ply/cgal-colors.ply", "PLY, ascii", 3, 0, "cin",
     "0.000 x 1.000 x 1.000; min 0.000 0.000 0.000", {-1, -1}, "", -1},
    {"ply/cgal-hippo1.ply", "PLY, binary little-endian", 6104, 0, "n",
     "0.997 x 0.526 x 0.315; min -0.500 -0.262 -0.156", {-1, -1}, "", -1},
    {"ply/guanyin-half-big-endian.ply", "PLY, binary big-endian", 119077, 0, "c",
     "0.986 x 1.291 x 0.822; min -0.511 0.002 -0.368", {-1, -1}, "", -1},
    {"ply/guanyin-statue.ply", "PLY, binary little-endian", 238154, 0, "c",
     "0.986 x 1.291 x 0.824; min -0.511 0.002 -0.370", {-1, -1}, "", -1},
    {"ply/pdal-simple_binary.ply", "PLY, binary little-endian", 3, 0, "",
     "2.000 x 1.000 x 0.000; min -1.000 0.000 0.000", {-1, -1}, "", -1},
    {"ply/pdal-simple_text.ply", "PLY, ascii", 3, 0, "",
     "2.000 x 1.000 x 0.000; min -1.000 0.000 0.000", {-1, -1}, "", -1},
    {"ply/pdal-text_extradim.ply", "PLY, ascii", 1, 0, "cn",
     "0.000 x 0.000 x 0.000; min -2.649 -13.095 0.006", {-1, -1}, "", -1},
    {"pcd/autzen-utm.pcd", "PCD 0.7, binary", 1065, 0, "cik",
     "998.81 x 1387.40 x 54.800; min 493994.87 4877429.62 123.93", {-1, -1}, "", -1},
    {"pcd/bun0.pcd", "PCD 0.7, ascii", 397, 0, "n",
     "0.154 x 0.147 x 0.113; min -0.094 0.037 -0.055", {-1, -1}, "", -1},
    {"pcd/colored_cloud.pcd", "PCD 0.7, binary", 1000, 0, "cn",
     "1.376 x 0.275 x 0.650; min -0.887 -0.651 0.882", {-1, -1}, "", -1},
    {"pcd/cturtle.pcd", "PCD 0.7, binary_compressed", 167198, 0, "i",
     "2.839 x 2.114 x 0.604; min -1.420 -1.050 1.396", {-1, -1}, "", -1},
    {"pcd/milk_color.pcd", "PCD 0.7, binary_compressed", 13704, 0, "c",
     "0.154 x 0.252 x 0.177; min -0.140 -0.264 0.714", {-1, -1}, "", -1},
    {"pcd/office1.pcd", "PCD 0.7, binary_compressed", 307200, 52744, "c",
     "4.150 x 3.778 x 3.531; min -2.645 -2.196 1.833", {-1, -1}, "", -1},
    {"pcd/rops_cloud.pcd", "PCD 0.7, ascii", 32087, 0, "",
     "0.826 x 0.489 x 0.392; min -0.420 -0.240 -1.402", {-1, -1}, "", -1},
    {"pcd/table_scene_mug_stereo_textured.pcd", "PCD 0.7, binary_compressed", 307200, 97920, "c",
     "1.172 x 0.690 x 1.903; min -0.456 -0.511 0.690", {-1, -1}, "", -1},
    {"pcd/utm17_comma.pcd", "PCD 0.7, ascii", 10, 0, "",
     "4.350 x 1.980 x 0.180; min 289814.15 4320978.61 170.58", {-1, -1}, "", -1},
    {"pcd/utm17_space.pcd", "PCD 0.7, ascii", 10, 0, "",
     "4.350 x 1.980 x 0.180; min 289814.15 4320978.61 170.58", {-1, -1}, "", -1},
    {"pcd/zaghetto.pcd", "PCD 0.7, binary", 59750, 0, "",
     "0.557 x 0.416 x 0.196; min 0.172 0.423 0.501", {-1, -1}, "", -1},
    {"las/autzen_trim.las", "LAS 1.2, point format 3", 110000, 0, "cik",
     "1177.46 x 562.70 x 114.25; min 636001.76 848935.20 406.26", {0, 254}, "1,2", 236},
    {"las/certainty3d-feet.las", "LAS 1.2, point format 3", 10126, 0, "cik",
     "3436.41 x 3869.85 x 275.18; min 6326726.54 2068062.39 2700.53", {56, 2505}, "", 65280},
    {"las/extrabytes.las", "LAS 1.4, point format 3", 1065, 0, "cik",
     "3362.70 x 4635.73 x 179.79; min 635619.85 848899.70 406.59", {0, 254}, "1,2", 249},
    {"las/las10-pdrf0.las", "LAS 1.0, point format 0", 11781, 0, "ik",
     "440.24 x 412.73 x 100.90; min 2483569.14 366203.87 1480.88", {0, 194}, "1,2,8,9,12,15", -1},
    {"las/las11-pdrf1.las", "LAS 1.1, point format 1", 1065, 0, "ik",
     "3362.70 x 4635.73 x 179.79; min 635619.85 848899.70 406.59", {0, 254}, "1,2", -1},
    {"las/las12-pdrf2-color.las", "LAS 1.2, point format 2", 1065, 0, "cik",
     "998.81 x 1387.40 x 54.800; min 493994.87 4877429.62 123.93", {0, 254}, "1,2", 249},
    {"las/las13-pdrf1-vegetation.las", "LAS 1.3, point format 1", 10683, 0, "ik",
     "3.758 x 6.012 x 4.888; min -98451.21 -55975.42 -81460.09", {0, 37522}, "", -1},
    {"las/las13-pdrf4-waveform.las", "LAS 1.3, point format 4", 999, 0, "ik",
     "498.68 x 103.10 x 8.717; min -235434.52 5800843.14 265.09", {0, 220}, "", -1},
    {"las/las14-evlr.las", "LAS 1.4, point format 6", 1000, 0, "ik",
     "501.23 x 5.270 x 6.320; min 1694038.45 1816492.71 5592.75", {2, 68}, "", -1},
    {"las/las14-pdrf6-wkt.las", "LAS 1.4, point format 6", 25408, 0, "ik",
     "59.990 x 39.980 x 51.260; min 2445180.00 604300.00 1352.70", {996, 57345}, "2,3,4,5,6,7", -1},
    {"las/las14-pdrf6.las", "LAS 1.4, point format 6", 1000, 0, "ik",
     "501.23 x 5.270 x 6.320; min 1694038.45 1816492.71 5592.75", {2, 68}, "", -1},
    {"las/las14-pdrf7-color.las", "LAS 1.4, point format 7", 22600, 0, "cik",
     "225.00 x 99.000 x 210.00; min 1.000 1.000 44.000", {0, 0}, "", 65024},
    {"las/lonlat-pdrf0.las", "LAS 1.2, point format 0", 5380, 0, "ik",
     "0.023 x 0.011 x 39.038; min -94.683 31.037 39.081", {65535, 65535}, "", -1},
    {"las/lots_of_vlr.las", "LAS 1.1, point format 1", 1, 0, "ik",
     "0.000 x 0.000 x 0.000; min 715001.35 839349.17 17.275", {105, 105}, "", -1},
    {"las/pdrf10-1.4.las", "LAS 1.4, point format 10", 1024, 0, "cik",
     "4.29e+09 x 4.29e+09 x 4.29e+09; min -2.14e+09 -2.15e+09 -2.15e+09", {27, 65529}, "0,2,3,4,5,6,7,8,9,11,12,13,14,15", 65528},
    {"las/pdrf5-1.3.las", "LAS 1.3, point format 5", 1024, 0, "cik",
     "173.91 x 112.53 x 22.080; min -70.000 -22.530 -10.000", {0, 37851}, "0,1,2,3,4,5,6,7,8,9,10,11,12,13", 65495},
    {"las/pdrf8-1.4.las", "LAS 1.4, point format 8", 1024, 0, "cik",
     "4.29e+09 x 4.29e+09 x 4.29e+09; min -2.14e+09 -2.15e+09 -2.15e+09", {27, 65529}, "0,2,3,4,5,6,7,8,9,11,12,13,14,15", 65528},
    {"las/pdrf9-1.4.las", "LAS 1.4, point format 9", 1024, 0, "ik",
     "4.27e+09 x 4.29e+09 x 4.29e+09; min -2.14e+09 -2.15e+09 -2.15e+09", {27, 65524}, "0,1,2,3,4,5,6,7,8,9,11,12,13,14", -1},
    {"las/permutation-1.0_0.las", "LAS 1.0, point format 0", 1, 0, "ik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", -1},
    {"las/permutation-1.0_1.las", "LAS 1.0, point format 1", 1, 0, "ik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", -1},
    {"las/permutation-1.1_0.las", "LAS 1.1, point format 0", 1, 0, "ik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", -1},
    {"las/permutation-1.1_1.las", "LAS 1.1, point format 1", 1, 0, "ik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", -1},
    {"las/permutation-1.2_0.las", "LAS 1.2, point format 0", 1, 0, "ik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", -1},
    {"las/permutation-1.2_1.las", "LAS 1.2, point format 1", 1, 0, "ik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", -1},
    {"las/permutation-1.2_2.las", "LAS 1.2, point format 2", 1, 0, "cik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", 255},
    {"las/permutation-1.2_3.las", "LAS 1.2, point format 3", 1, 0, "cik",
     "0.000 x 0.000 x 0.000; min 470692.44 4602888.90 16.000", {0, 0}, "", 255},
    {"las/sample_c.las", "LAS 1.2, point format 3", 14408, 0, "cik",
     "83.400 x 74.880 x 28.700; min 674521.92 1206740.08 627.53", {103, 2687}, "2,3,4,5,6,11,14,31", 54272},
    {"las/warsaw_small.las", "LAS 1.2, point format 3", 3000, 0, "cik",
     "33.490 x 32.770 x 19.850; min 639913.26 485143.14 84.700", {67, 62657}, "0,2,3,4,5", 53760},
    {"text/autzen.pts", "PTS: x y z intensity red green blue", 10, 0, "ci",
     "23.560 x 376.40 x 84.220; min 636102.84 848968.80 427.92", {800, 42410}, "", 128},
    {"text/bunny_8.pts", "PTS: x y z", 9, 0, "",
     "0.101 x 0.039 x 0.035; min -0.068 0.113 0.002", {-1, -1}, "", -1},
    {"text/kitten.xyz", "text: x y z nx ny nz", 5210, 0, "n",
     "0.651 x 0.999 x 0.591; min -0.325 -0.500 -0.296", {-1, -1}, "", -1},
    {"text/lion-110k.pts", "PTS: x y z intensity red green blue", 110000, 0, "ci",
     "3.900 x 2.840 x 2.850; min -4.840 1.040 -3.450", {6417, 65535}, "", 255},
    {"text/poste_france.xyz", "text: x y z", 9031, 0, "",
     "165.08 x 167.45 x 116.32; min -91.106 -90.341 -38.543", {-1, -1}, "", -1},
    {"text/radar.xyz", "text: x y z", 20950, 0, "",
     "199.33 x 199.15 x 199.98; min -99.739 -99.996 -100.00", {-1, -1}, "", -1},
    {"text/test.pts", "PTS: x y z intensity red green blue", 19, 0, "ci",
     "29.031 x 22.527 x 1.991; min -25.050 -24.534 -2.001", {10418, 17812}, "", 97},
    // SOURCES.md has these before the transform; after it, apart from this program: row vector times matrix.
    {"text/1.2-with-color.ptx", "PTX: x y z intensity red green blue", 1065, 0, "ci",
     "3362.70 x 4635.73 x 179.79; min 635619.85 848899.70 406.59", {0, 4064}, "", 249},
    {"text/complex-transform.ptx", "PTX: x y z intensity red green blue", 12, 8, "ci",
     "0.000048 x 0.005251 x 0.003046; min -3.034407 -3.173781 -1.825115", {32102, 32446}, "", 38},
    {"text/multiple-and-transform.ptx", "PTX: x y z intensity", 8, 0, "i",
     "312.860 x 115.650 x 21.000; min 636699.380 848991.010 425.390", {288, 2288}, "", -1},
    {"text/no-color.ptx", "PTX: x y z intensity", 15, 0, "i",
     "1217.000 x 399.770 x 37.790; min 635795.240 848991.010 408.600", {16, 3312}, "", -1},
};
// clang-format on

}  // namespace scancast::test
