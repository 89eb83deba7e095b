#include "server/catalog/cloud_admin.hpp"

#include <utility>

#include "protocol/nearest_name.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Problem> refuse(int status, std::string detail, const char* field) {
    Problem problem = problemOf(status, std::move(detail));
    problem.errors.push_back({field, problem.detail});
    return tl::unexpected(std::move(problem));
}

}  // namespace

CloudAdmin::CloudAdmin(Catalog& catalog, fs::path dataRoot, std::size_t mostClouds)
    : catalog_(catalog), dataRoot_(std::move(dataRoot)), mostClouds_(mostClouds) {}

void CloudAdmin::loadWith(Load load) {
    const std::lock_guard lock(mutex_);
    load_ = std::move(load);
}

// Answers repeat what was asked, not where things are.
tl::expected<ScanInput, Problem> CloudAdmin::open(const std::string& name) const {
    if (dataRoot_.empty())
        return refuse(403, "This server opens no further files: it was started without --data-root.", "file");
    // Every time anew: whoever runs the server may have put another folder there.
    const auto root = InputFolder::open(dataRoot_);
    if (!root) return refuse(404, "The folder of --data-root is not there any more.", "file");
    const auto outside =
        refuse(403, "Only files below --data-root can be opened, by their path relative to it.", "file");
    if (name.empty() || name.find('\0') != std::string::npos) return outside;
    auto input = ScanInput::openBeneath(*root, name);
    if (input) return std::move(*input);
    switch (input.error().code) {
        case ErrorCode::InvalidArgument:
            return outside;
        case ErrorCode::NotFound:
            return refuse(404, "There is no file " + quoteText(name) + " below --data-root.", "file");
        case ErrorCode::Unsupported:
            return refuse(422, quoteText(name) + " is no file, and no folder of an octree of EPT or Potree.", "file");
        default:
            return refuse(422, quoteText(name) + " cannot be opened by this server.", "file");
    }
}

tl::expected<std::string, Problem> CloudAdmin::add(const AddCloud& asked) {
    if (!asked.id.empty() && cloudIdFor(asked.id) != asked.id)
        return refuse(
            400,
            "id: letters, digits, '.', '_' and single '-' make an id, such as " + cloudIdFor(asked.id) + ".",
            "id");
    auto input = open(asked.file);
    if (!input) return passOn(input);
    const std::string name = input->path().stem().string();
    const std::lock_guard lock(mutex_);
    if (!load_) return refuse(503, "This server does not load files now.", "file");
    if (const std::size_t there = catalog_.size(); there >= mostClouds_)
        return refuse(
            409,
            "This server has " + std::to_string(there) + " clouds, and may have " +
                std::to_string(mostClouds_) +
                " (--max-clouds, live ones and those that could not be loaded included); DELETE one first.",
            "file");
    std::string id = asked.id;
    if (id.empty()) {
        id = catalog_.add(name);
    } else if (!catalog_.addAs(id, name)) {
        return refuse(
            409, "There is a cloud named " + quoteText(id) + " already; DELETE it first, or take another id.",
            "id");
    }
    if (!asked.title.empty()) catalog_.setTitle(id, asked.title);
    if (load_(std::move(*input), id)) return id;
    catalog_.remove(id);
    return refuse(503, "Too many clouds wait to be loaded; try again in a moment.", "file");
}

tl::expected<void, Problem> CloudAdmin::remove(std::string_view id) {
    const auto entry = catalog_.find(id);
    if (!entry) return tl::unexpected(catalog_.cloud(id).error());
    if (entry->state == CloudState::Loading)
        return refuse(409,
                      "The cloud " + quoteText(id) + " is still being loaded; remove it when it is done.",
                      "cloud");
    if (entry->live)
        return refuse(
            409, "The cloud " + quoteText(id) + " is live: it was named when the server started, and stays.",
            "cloud");
    catalog_.remove(id);
    return {};
}

}  // namespace scancast
