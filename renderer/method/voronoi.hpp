// `voronoi`: oriented discs clipped to each other, so that what remains of each is its cell of the surface's
// Voronoi diagram; flat, or with a smooth field of colours and normals inside the cells.
// docs/spec/voronoi.md §2. Source:
// Talton, Carr and Hart, "Voronoi Rasterization of Sparse Point Sets", 2005, §3.
//
//   paper                                        here
//
//   §3.1, §3.2: occluding discs, r = 1.3 σ       Surfel::radius · `scale`; it overlaps as much
//   §3.4, first pass: front-facing discs         NearestPass → d_vis
//   §3.4, (A): drop what is further than r/2     CellPass' `tolerance`, in radii; 1 by default, as our radii
//     from the depth                             overlap more. Of what faces another way than what is visible
//                                                it is measured across the surface, and dropped is what goes
//                                                on behind a concave crease
//   §3.4, (B): depth := distance to the centre   CellPass' order; less where what is visible hangs over a
//                                                convex crease (voronoi.md §4)
//   §3.5: discs over their neighbours' centres   SumPass with `reach` 2, after the cells: of a cell's own
//                                                surface, by the angle between the normals
//   §3.5, Eq. 1                                  w = 1 - 3t² + 2t³: as printed the two terms have their signs
//                                                swapped, and the bump that the text describes grows outwards
//   §3.6: back-facing discs clip the outline     SilhouettePass, parameter `silhouette`; not reliable, as the
//                                                paper says: off by default
//   §3.5: Phong shading of the field             PhongPass over the means of SumPass
#pragma once

#include "renderer/method/method.hpp"

namespace scancast {

Method voronoiMethod();

}  // namespace scancast
