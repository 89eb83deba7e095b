#include "server/loader.hpp"

#include <chrono>
#include <utility>

#include "renderer/cloud/cloud.hpp"

namespace scancast {
namespace {

// Ends a scan early when the server is shut down.
class StoppableSource final : public PointSource {
  public:
    StoppableSource(std::unique_ptr<PointSource> source, const std::atomic<bool>& stop)
        : source_(std::move(source)), stop_(stop) {}
    const ScanHeader& header() const override { return source_->header(); }
    Expected<bool> read(PointBatch& batch) override {
        if (stop_) return fail(ErrorCode::Cancelled, "The server is shutting down.");
        return source_->read(batch);
    }
    std::uint64_t droppedPoints() const override { return source_->droppedPoints(); }
    std::array<std::uint64_t, 2> bytesRead() const override { return source_->bytesRead(); }

  private:
    std::unique_ptr<PointSource> source_;
    const std::atomic<bool>& stop_;
};

}  // namespace

Loader::Loader(std::vector<std::filesystem::path> files, Catalog& catalog, LoaderOptions options)
    : files_(std::move(files)), catalog_(catalog), options_(std::move(options)) {
    for (const auto& file : files_) ids_.push_back(catalog_.add(file.stem().string()));
    thread_ = std::thread([this] { run(); });
}

Loader::~Loader() {
    requestStop();
    thread_.join();
}

void Loader::run() {
    for (std::size_t i = 0; i < files_.size() && !stop_; ++i) loadOne(files_[i], ids_[i]);
    finished_ = true;
}

void Loader::loadOne(const std::filesystem::path& file, const std::string& id) {
    const auto start = std::chrono::steady_clock::now();
    auto source = openScan(file, options_.import);
    auto cloud = Expected<std::shared_ptr<const Cloud>>(nullptr);
    if (source) {
        StoppableSource stoppable(std::move(*source), stop_);
        BuildOptions build;
        build.title = file.filename().string();
        build.threads = options_.threads;
        cloud = buildCloud(stoppable, build, [&](const Progress& progress) {
            catalog_.setProgress(id, progress.stage, progress.done, progress.total);
            if (options_.onProgress) options_.onProgress(id, progress);
        });
    } else {
        cloud = tl::unexpected(std::move(source.error()));
    }
    if (!cloud) {
        ++failed_;
        catalog_.setFailed(id);
        Error error = std::move(cloud.error());
        if (error.message.find(file.filename().string()) == std::string::npos) {
            error.message = file.string() + ": " + error.message;
        }
        if (options_.onFailed && error.code != ErrorCode::Cancelled) options_.onFailed(error);
        return;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (options_.onLoaded) options_.onLoaded({id, **cloud, seconds});
    catalog_.setReady(id, std::move(*cloud));
}

}  // namespace scancast
