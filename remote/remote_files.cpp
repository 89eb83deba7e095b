#include "remote/remote_files.hpp"

#include <future>
#include <utility>

namespace scancast {
namespace {

class SharedReader final : public RandomReader {
  public:
    explicit SharedReader(std::shared_ptr<const RemoteFile> file) : file_(std::move(file)) {}
    std::uint64_t size() const override { return file_->size(); }
    Expected<std::size_t> readAt(std::uint64_t offset, std::span<std::byte> into) const override {
        return file_->readAt(offset, into);
    }
    void expect(std::uint64_t offset, std::uint64_t bytes) const override { file_->expect(offset, bytes); }
    bool forget(std::uint64_t offset, std::uint64_t bytes) const override {
        return file_->forget(offset, bytes);
    }
    bool isRemote() const override { return true; }
    bool isAway() const override { return file_->isAway(); }

  private:
    const std::shared_ptr<const RemoteFile> file_;
};

Error errorOf(const RequestFault& fault, const std::string& shown) {
    ErrorCode code = ErrorCode::Unavailable;
    if (fault.kind == RequestFault::Kind::Unsuitable) code = ErrorCode::Unsupported;
    if (fault.kind == RequestFault::Kind::Refused)
        code = fault.isMissing() ? ErrorCode::NotFound : ErrorCode::Io;
    return {code, shown + ": " + fault.text, {}};
}

}  // namespace

struct RemoteFiles::Changes {
    std::mutex mutex;
    std::function<void()> tell;
};

RemoteFiles::RemoteFiles(RemoteOptions options)
    : options_(std::move(options)), changes_(std::make_shared<Changes>()) {}

RemoteFiles::~RemoteFiles() {
    if (options_.stopsWithOwner) stop();
}

Expected<std::shared_ptr<RemoteCommons>> RemoteFiles::commons() {
    const std::lock_guard lock(mutex_);
    if (stopping_) return fail(ErrorCode::Cancelled, "This program is ending.");
    if (commons_) return commons_;
    auto made = std::make_shared<RemoteCommons>();
    auto transfers = Transfers::create(options_.transfers);
    if (!transfers) return passOn(std::move(transfers));
    made->transfers = std::move(*transfers);
    if (!options_.folder.empty()) {
        auto folder = PieceFolder::open(options_.folder, options_.folderLimit);
        if (!folder) return passOn(std::move(folder));
        made->folder = std::move(*folder);
    }
    made->memory = options_.memory;
    made->reserve = options_.reserve;
    if (options_.reserve) made->reserved = options_.reserve(options_.memory);
    made->pace = options_.pace;
    made->tries = options_.tries;
    made->firstProbe = options_.firstProbe;
    made->lastProbe = options_.lastProbe;
    made->onNote = options_.onNote;
    made->onChanged = [changes = changes_] {
        const std::lock_guard telling(changes->mutex);
        if (changes->tell) changes->tell();
    };
    commons_ = std::move(made);
    return commons_;
}

Expected<std::shared_ptr<RemoteFile>> RemoteFiles::open(const RemoteUrl& url) {
    auto access = accessTo(url, options_.environment);
    if (!access) return passOn(std::move(access));
    auto shared = commons();
    if (!shared) return passOn(std::move(shared));
    const auto object = std::make_shared<const ObjectAccess>(std::move(*access));
    // Its size comes with its first bytes: a presigned URL is for GET alone.
    const auto first = std::make_shared<std::promise<PartOrFault>>();
    PartAsk ask{object, 0, RemoteFile::pieceBytes};
    ask.tries = (*shared)->tries;
    (*shared)->transfers->start(std::move(ask),
                                [first](PartOrFault part) { first->set_value(std::move(part)); });
    const auto begun = std::chrono::steady_clock::now();
    auto start = first->get_future().get();
    if (!start) return tl::unexpected(errorOf(start.error(), url.shown()));
    auto file = RemoteFile::create(std::move(*shared), object, url.identity(), std::move(*start),
                                   std::chrono::steady_clock::now() - begun);
    const std::lock_guard lock(mutex_);
    std::erase_if(open_, [](const auto& one) { return one.second.expired(); });
    open_.emplace(url.identity(), file);
    return file;
}

Expected<std::shared_ptr<RemoteFolder>> RemoteFiles::around(const RemoteUrl& url,
                                                            std::shared_ptr<RemoteFile> description) {
    if (url.isPresigned())
        return fail(ErrorCode::InvalidArgument,
                    url.shown() +
                        ": a presigned URL is for one object, and this one describes many; give s3:// "
                        "with credentials in the environment, or a URL that needs none");
    auto shared = commons();
    if (!shared) return passOn(std::move(shared));
    auto folder = RemoteFolder::create(std::move(*shared), std::move(description), url, options_.environment);
    const std::lock_guard lock(mutex_);
    std::erase_if(folders_, [](const auto& one) { return one.second.expired(); });
    folders_.emplace(url.identity(), folder);
    return folder;
}

void RemoteFiles::signAnew(const RemoteUrl& url) {
    auto access = accessTo(url, options_.environment);
    if (!access) return;
    const auto object = std::make_shared<const ObjectAccess>(std::move(*access));
    // The last who has one does not let go of it under the lock.
    std::vector<std::shared_ptr<RemoteFile>> files;
    std::vector<std::shared_ptr<RemoteFolder>> folders;
    const std::lock_guard lock(mutex_);
    const auto [firstFolder, endOfFolders] = folders_.equal_range(url.identity());
    for (auto one = firstFolder; one != endOfFolders; ++one)
        if (auto folder = one->second.lock()) folders.push_back(std::move(folder));
    for (const auto& folder : folders) folder->signAnew(url);
    const auto [first, end] = open_.equal_range(url.identity());
    for (auto one = first; one != end; ++one)
        if (auto file = one->second.lock()) files.push_back(std::move(file));
    for (const auto& file : files) file->signAnew(object);
}

Expected<RemoteDocument> RemoteFiles::fetch(const RemoteUrl& url, std::uint64_t most,
                                            const std::string& unless) {
    auto access = accessTo(url, options_.environment);
    if (!access) return passOn(std::move(access));
    return fetch(std::move(*access), url.shown(), most, unless);
}

Expected<RemoteDocument> RemoteFiles::fetch(const ListAsk& ask, const std::string& shown,
                                            std::uint64_t most) {
    auto access = accessTo(ask, options_.environment);
    if (!access) return passOn(std::move(access));
    return fetch(std::move(*access), shown, most, {});
}

Expected<RemoteDocument> RemoteFiles::fetch(ObjectAccess access, const std::string& shown, std::uint64_t most,
                                            const std::string& unless) {
    auto shared = commons();
    if (!shared) return passOn(std::move(shared));
    const auto all = std::make_shared<std::promise<PartOrFault>>();
    PartAsk ask{std::make_shared<const ObjectAccess>(std::move(access)), 0, most};
    ask.whole = ask.isDocument = true;
    ask.unless = unless;
    (*shared)->transfers->start(std::move(ask), [all](PartOrFault part) { all->set_value(std::move(part)); });
    auto part = all->get_future().get();
    if (!part) return tl::unexpected(errorOf(part.error(), shown));
    const auto* const text = reinterpret_cast<const char*>(part->bytes.data());
    return RemoteDocument{std::string(text, part->bytes.size()), std::move(part->state.etag),
                          part->isUnchanged};
}

void RemoteFiles::onChanged(std::function<void()> tell) {
    const std::lock_guard lock(changes_->mutex);
    changes_->tell = std::move(tell);
}

void RemoteFiles::stop() {
    std::shared_ptr<RemoteCommons> commons;
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
        commons = commons_;
    }
    if (commons) commons->transfers->stop();
}

RemoteStats RemoteFiles::stats() const {
    const std::lock_guard lock(mutex_);
    RemoteStats stats;
    if (!commons_) return stats;
    stats.transfers = commons_->transfers->stats();
    stats.memoryHits = commons_->memoryHits;
    stats.diskHits = commons_->diskHits;
    stats.misses = commons_->misses;
    stats.files = commons_->files;
    stats.away = commons_->away;
    if (commons_->folder) {
        stats.brokenPieces = commons_->folder->broken();
        stats.folderBytes = commons_->folder->bytes();
        stats.folderLimit = commons_->folder->limit();
    }
    return stats;
}

std::unique_ptr<RandomReader> readerOf(std::shared_ptr<const RemoteFile> file) {
    return std::make_unique<SharedReader>(std::move(file));
}

}  // namespace scancast
