// The words about each foreign format, once. Data; included by foreign_formats.cpp alone.
#pragma once

#include "renderer/cloud/import/foreign/foreign_formats.hpp"

namespace scancast::foreign {

using F = ForeignFormat;

// Of scanners' and surveyors' programs.
inline constexpr F cloudCompare{"a CloudCompare BIN file",
                                "open it in CloudCompare and save it as LAS, E57 or PLY, or run "
                                "\"CloudCompare -SILENT -O scan.bin -C_EXPORT_FMT LAS -SAVE_CLOUDS\""};
inline constexpr F terraScan{
    "a TerraScan BIN file",
    "save it as LAS in TerraScan, or run \"pdal translate -r readers.terrasolid scan.bin scan.laz\""};
inline constexpr F recap{"an Autodesk ReCap project or scan (RCP, RCS)",
                         "open it in Autodesk ReCap and export it as E57 or PTS"};
inline constexpr F faro{"a FARO scan or project (FLS, FWS, LSPROJ)",
                        "open it in FARO SCENE and export the scan points as E57"};
inline constexpr F zollerFroehlich{"a Z+F scan or project (ZFS, ZFPRJ)",
                                   "open it in Z+F LaserControl and export it as E57 or PTX"};
inline constexpr F rieglRxp{
    "a RIEGL scan (RXP)",
    "export it as LAZ or E57 in RiSCAN PRO, or run \"pdal translate scan.rxp scan.laz\" with a PDAL that "
    "was built with RIEGL's RiVLib"};
inline constexpr F rieglRdb{
    "a RIEGL point database (RDBX)",
    "export it as LAZ or E57 in RiSCAN PRO or RiPROCESS, or run \"pdal translate -r readers.rdb scan.rdbx "
    "scan.laz\" with a PDAL that was built with RIEGL's RDB library"};
inline constexpr F leicaPtg{"a Leica PTG scan", "open it in Leica Cyclone and export it as E57 or PTX"};
inline constexpr F leicaProject{
    "a Leica project (LGS, LGSX, IMP)",
    "open it in Leica Cyclone, or Cyclone REGISTER 360, and export it as E57 or PTX"};
inline constexpr F trimble{"a Trimble scan (TZF, TZS, RWP)",
                           "open it in Trimble RealWorks and export it as E57 or LAZ"};
inline constexpr F topcon{"a Topcon scan (CLR, CL3)",
                          "open it in Topcon ScanMaster or MAGNET Collage and export it as E57 or PTX"};
inline constexpr F pointools{"a Bentley Pointools cloud (POD)",
                             "open it in a program by Bentley and export it as E57 or LAS"};
inline constexpr F bpf{"a BPF point file", "run \"pdal translate scan.bpf scan.laz\""};
inline constexpr F lasIndex{"the spatial index of a LAS or LAZ file (LAX), without points",
                            "give the LAS or LAZ file beside it"};
inline constexpr F waveform{"the waveforms of a LAS file (WDP), without points",
                            "give the LAS file beside it"};

// Made for the web, and models.
inline constexpr F gltf{
    "a glTF model", "convert it to PLY, in Blender or MeshLab, or by \"assimp export model.glb model.ply\""};
inline constexpr F tiles{"a 3D Tiles tileset or tile (tileset.json, PNTS, B3DM, I3DM, CMPT)",
                         "tiles are made for viewers from a scan: ask for that one, as LAS, LAZ or E57"};
inline constexpr F spz{"a compressed Gaussian splat (SPZ)",
                       "convert it to PLY, for example by \"splat-transform scene.spz scene.ply\""};
inline constexpr F splat{"a Gaussian splat (SPLAT, KSPLAT, SOG)",
                         "convert it to PLY, for example by \"splat-transform scene.splat scene.ply\""};
inline constexpr F slpk{"an Esri scene layer package (SLPK)",
                        "run \"pdal translate -r readers.slpk layer.slpk layer.laz\" if it is one of points"};
inline constexpr F draco{"a Draco mesh or cloud",
                         "convert it to PLY by \"draco_decoder -i scan.drc -o scan.ply\""};
inline constexpr F stl{"an STL mesh",
                       "convert it to PLY, in MeshLab or by \"assimp export mesh.stl mesh.ply\""};
inline constexpr F off{"an OFF mesh",
                       "convert it to PLY, in MeshLab or by \"assimp export mesh.off mesh.ply\""};
inline constexpr F fbx{"an FBX model",
                       "convert it to PLY, in Blender or by \"assimp export model.fbx model.ply\""};
inline constexpr F collada{"a COLLADA model (DAE)",
                           "convert it to PLY, in MeshLab or by \"assimp export model.dae model.ply\""};
inline constexpr F vrml{"a VRML or X3D model", "convert it to PLY in MeshLab"};
inline constexpr F vtk{"a VTK data set", "open it in ParaView and save it as PLY or CSV"};
inline constexpr F ifc{"a building model (IFC, STEP)",
                       "it holds surfaces and no scan: give the scan that it was drawn from"};

// Drawings, maps, grids.
inline constexpr F dxf{"a DXF drawing", "open it in CloudCompare and save its points as LAS or PLY"};
inline constexpr F dwg{
    "a DWG drawing",
    "save it as DXF in AutoCAD, open that in CloudCompare and save its points as LAS or PLY"};
inline constexpr F asciiGrid{"an Esri ASCII grid",
                             "make points of its cells by \"gdal_translate -of XYZ grid.asc grid.xyz\""};
inline constexpr F binaryGrid{"an Esri binary grid (ADF)",
                              "make points of its cells by \"gdal_translate -of XYZ hdr.adf grid.xyz\""};
inline constexpr F tiff{"a TIFF picture or a GeoTIFF grid",
                        "make points of a grid of heights by \"gdal_translate -of XYZ grid.tif grid.xyz\""};
inline constexpr F shapefile{
    "a shapefile",
    "make a table of its points by \"ogr2ogr -f CSV points.csv points.shp -lco GEOMETRY=AS_XYZ\""};
inline constexpr F geoPackage{
    "a GeoPackage or another SQLite database",
    "make a table of its points by \"ogr2ogr -f CSV points.csv points.gpkg -lco GEOMETRY=AS_XYZ\""};
inline constexpr F hdf5{
    "an HDF5 file (of NetCDF 4, MATLAB and others, too)",
    "write its columns x, y, z as text, or run \"pdal translate\" with PDAL's readers.hdf"};
inline constexpr F netCdf{"a NetCDF file",
                          "make points of a grid by \"gdal_translate -of XYZ grid.nc grid.xyz\""};
inline constexpr F numpy{"an array of NumPy",
                         "write it as text: numpy.savetxt('scan.xyz', numpy.load('scan.npy'))"};
inline constexpr F parquet{"a Parquet table", "write its columns x, y, z as CSV"};
inline constexpr F rosBag{
    "a recording of ROS (bag, MCAP)",
    "write its clouds as PCD, for example by \"rosrun pcl_ros bag_to_pcd scan.bag /points out\""};

// Packed, and what is no scan at all.
inline constexpr F zip{"a ZIP archive", "unpack it first, for example with \"unzip\""};
inline constexpr F gzip{"compressed with gzip", "unpack it first, for example with \"gunzip\""};
inline constexpr F bzip2{"compressed with bzip2", "unpack it first, for example with \"bunzip2\""};
inline constexpr F xz{"compressed with xz", "unpack it first, for example with \"unxz\""};
inline constexpr F zstd{"compressed with zstd", "unpack it first, for example with \"unzstd\""};
inline constexpr F sevenZip{"a 7-Zip archive", "unpack it first, for example with \"7z x\""};
inline constexpr F rar{"a RAR archive", "unpack it first, for example with \"unrar x\""};
inline constexpr F tar{"a TAR archive", "unpack it first, for example with \"tar -xf\""};
inline constexpr F picture{"a picture (JPEG, PNG, GIF, WebP)", "give the scan that it was made of"};
inline constexpr F pdf{"a PDF document", "give the scan that it is about"};
inline constexpr F webPage{"a web page",
                           "the download did not yield the scan; look at it in a browser, it may say why"};
inline constexpr F xml{"an XML document", "give the scan that it describes"};
inline constexpr F json{"JSON text", "give the scan that it describes"};
inline constexpr F ole{"an OLE compound file, as FARO's programs and old office programs write them",
                       "of a scan, open it in the program that wrote it and export it as E57"};
inline constexpr F lfsPointer{"a Git LFS pointer, not the scan itself",
                              "fetch the scan with \"git lfs pull\""};
inline constexpr F program{"a program", "give a scan"};

}  // namespace scancast::foreign
