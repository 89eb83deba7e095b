#include "renderer/cloud/build/nodes/set_aside.hpp"

namespace scancast {

Expected<void> setAside(BuildNode& node, Workspace& workspace) {
    auto& samples = node.content.samples;
    auto& reaches = node.content.reaches;
    auto& densities = node.content.densities;
    auto& beside = node.content.beside;
    const std::uint64_t toReaches = samples.size() * sizeof(Sample),
                        toDensities = toReaches + reaches.size() * sizeof(float),
                        toBeside = toDensities + densities.size() * sizeof(Density);
    auto room = workspace.allocate(toBeside + beside.size() * sizeof(BesideWord));
    if (!room) return passOn(room);
    auto done = room->write(0, std::as_bytes(std::span(samples)));
    if (done) done = room->write(toReaches, std::as_bytes(std::span(reaches)));
    if (done) done = room->write(toDensities, std::as_bytes(std::span(densities)));
    if (done) done = room->write(toBeside, std::as_bytes(std::span(beside)));
    if (!done) return done;
    node.setAside = std::move(*room);
    giveBack(samples);
    giveBack(reaches);
    giveBack(densities);
    giveBack(beside);
    return {};
}

}  // namespace scancast
