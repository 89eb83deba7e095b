#include "renderer/cloud/build/chunks/counting_grid.hpp"

#include <bit>

namespace scancast {

CellTable::CellTable(std::size_t expected) {
    const std::size_t slots = std::bit_ceil(std::max<std::size_t>(64, expected * 2));
    slots_.assign(slots, {empty, 0});
    shift_ = 64 - unsigned(std::bit_width(slots - 1));
}

std::size_t CellTable::slotOf(CellKey key) const {
    std::size_t at = placeOf(key);
    while (slots_[at].key != key && slots_[at].key != empty) at = (at + 1) & (slots_.size() - 1);
    return at;
}

std::uint64_t& CellTable::operator[](CellKey key) {
    std::size_t at = slotOf(key);
    if (slots_[at].key == empty) {
        if (++size_ * 2 > slots_.size()) {
            grow();
            at = slotOf(key);
        }
        slots_[at].key = key;
    }
    return slots_[at].points;
}

const std::uint64_t* CellTable::find(CellKey key) const {
    const CountedCell& slot = slots_[slotOf(key)];
    return slot.key == empty ? nullptr : &slot.points;
}

void CellTable::grow() {
    CellTable larger(slots_.size());
    for (const CountedCell& slot : slots_)
        if (slot.key != empty) larger.slots_[larger.slotOf(slot.key)] = slot;
    slots_ = std::move(larger.slots_);
    shift_ = larger.shift_;
}

CountingGrid::CountingGrid(const GridBox& box) : box_(box) {
    for (int a = 0; a < 3; ++a)
        while ((box.max[a] >> frame_.cellLevel) - (box.min[a] >> frame_.cellLevel) >= 1024)
            ++frame_.cellLevel;
    for (int a = 0; a < 3; ++a) frame_.first[a] = box.min[a] >> frame_.cellLevel;
}

void CountingGrid::add(std::span<const BuildPoint> points) {
    for (std::size_t i = 0; i < points.size();) {
        // Scanners write neighbours one after the other: runs in one cell are counted at once.
        const CellKey key = frame_.key(points[i].position());
        const std::size_t first = i;
        if (i + cellsExpected < points.size())
            table_.expect(frame_.key(points[i + cellsExpected].position()));
        while (++i < points.size() && frame_.key(points[i].position()) == key) {
        }
        table_[key] += i - first;
        coarsenIfFull();
    }
}

void CountingGrid::join(const CountingGrid& other) {
    CountingGrid theirs = other;
    const int cellLevel = std::max(frame_.cellLevel, theirs.frame_.cellLevel);
    coarsenTo(cellLevel);
    theirs.coarsenTo(cellLevel);
    theirs.table_.forEach([&](CellKey key, std::uint64_t points) { table_[key] += points; });
    coarsenIfFull();
}

void CountingGrid::coarsenIfFull() {
    while (table_.size() > mostCells) coarsenTo(frame_.cellLevel + 1);
}

void CountingGrid::coarsenTo(int cellLevel) {
    if (cellLevel == frame_.cellLevel) return;
    CellFrame coarser{.first = {}, .cellLevel = cellLevel};
    for (int a = 0; a < 3; ++a) coarser.first[a] = box_.min[a] >> cellLevel;
    CellTable table;
    table_.forEach([&](CellKey key, std::uint64_t points) {
        GridPosition p;
        for (int a = 0; a < 3; ++a) p[a] = (frame_.first[a] + cellAxis(key, a)) << frame_.cellLevel;
        table[coarser.key(p)] += points;
    });
    frame_ = coarser;
    table_ = std::move(table);
}

std::vector<CountedCell> CountingGrid::cells() const {
    std::vector<CountedCell> cells;
    cells.reserve(table_.size());
    table_.forEach([&](CellKey key, std::uint64_t points) { cells.push_back({key, points}); });
    std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    return cells;
}

}  // namespace scancast
