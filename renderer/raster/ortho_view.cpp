#include "renderer/raster/ortho_view.hpp"

#include <cstring>

#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

/// The picture that a block is drawn as, in cells of the raster, of which some may lie outside.
CellWindow pictureOf(const OrthoViews& views, const CellWindow& block) {
    if (views.margin == 0) return block;
    return {block.column - views.margin, block.row - views.margin, views.grid.block + 2 * views.margin,
            views.grid.block + 2 * views.margin};
}

}  // namespace

Expected<OrthoViews> orthoViews(const Cloud& cloud, RasterGrid grid, const WordValues& words, int largest) {
    OrthoViews views{grid, defaultView(cloud), 0};
    views.base.style.background.kind = Background::Kind::Transparent;
    auto view = applyWords(views.base, words);
    if (!view) return passOn(std::move(view));
    views.base = std::move(*view);
    if (grid.columns <= largest && grid.rows <= largest) {
        views.grid.block = (int(std::max(grid.columns, grid.rows)) + grid.tile - 1) / grid.tile * grid.tile;
    } else {
        views.grid.block = std::max(grid.tile, largest / 2 / grid.tile * grid.tile);
        views.margin = 1;  // for the plan that tells how much it is
    }
    const auto planned = plan(cloud, orthoView(cloud, views, views.grid.blockAt(0)));
    if (!planned) return passOn(planned);
    if (views.margin > 0) {
        // Whoever tells what it looks at by a pixel more or less is on the safe side.
        views.margin = (*planned)->margin + 2;
    }
    return views;
}

View orthoView(const Cloud& cloud, const OrthoViews& views, const CellWindow& block) {
    const RasterGrid& grid = views.grid;
    const CellWindow picture = pictureOf(views, block);
    View view = views.base;
    view.width = int(picture.columns);
    view.height = int(picture.rows);
    const double x = grid.left + (double(picture.column) + double(picture.columns) / 2) * grid.cell;
    const double y = grid.top - (double(picture.row) + double(picture.rows) / 2) * grid.cell;
    const double low = cloud.bounds[0].z, high = cloud.bounds[1].z;
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.target = {x, y, low};
    camera.eye = {x, y, high + std::max(1.0, high - low)};
    camera.up = {0, 1, 0};
    camera.viewHeight = double(picture.rows) * grid.cell;
    view.camera = camera;
    return view;
}

Expected<std::vector<std::byte>> cellsOf(const OrthoViews& views, const CellWindow& block,
                                         std::span<const std::uint8_t> rgba) {
    const CellWindow picture = pictureOf(views, block);
    if (rgba.size() != std::size_t(picture.cells()) * 4)
        return fail(ErrorCode::Internal, "An orthophoto's block was drawn in another size than it has.");
    std::vector<std::byte> cells(std::size_t(block.cells()) * 4);
    const auto row = std::size_t(block.columns) * 4;
    for (std::int64_t y = 0; y < block.rows; ++y) {
        const auto from =
            std::size_t((block.row - picture.row + y) * picture.columns + block.column - picture.column) * 4;
        std::memcpy(&cells[std::size_t(y) * row], &rgba[from], row);
    }
    return cells;
}

}  // namespace scancast
