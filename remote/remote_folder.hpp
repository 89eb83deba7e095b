// Objects that lie beside one that describes them, as the tiles and pages of an EPT set do: each fetched whole, when it is wanted, many under way
// at once over connections that are kept. They stay in memory for a while, and on disk where there is a folder for them.
//
// Whether the server is there is a state of all of them together, and the description's (remote_file.hpp): when nothing comes, or a refusal, what is
// not here fails at once with Unavailable until the description can be had again. An object that is not there is missing, and nothing else is.
// The set is what its description is: a description that is another one (by its ETag) makes it another set, which whoever wants it opens anew.
// What replaces a tile while the description stays is not noticed by itself.
//
// Owned by its readers together. *Thread safety*: every function may be called from any thread; read() waits. Place: native cloud →
// **remote folder** → transfers, piece folder.
#pragma once

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "files/folder_reader.hpp"
#include "remote/remote_file.hpp"
#include "remote/remote_url.hpp"
#include "threads/monitor.hpp"

namespace scancast {

class RemoteFolder final : public FolderReader, public std::enable_shared_from_this<RemoteFolder> {
  public:
    /// `description` was opened by `url`: what is called as it is beside it is read from there.
    static std::shared_ptr<RemoteFolder> create(std::shared_ptr<RemoteCommons> commons,
                                                std::shared_ptr<RemoteFile> description, RemoteUrl url,
                                                RemoteEnvironment environment);

    /// Errors also: Unsupported for a server that compresses; Io for one that refuses this one alone.
    Expected<std::vector<std::byte>> read(const std::string& name, std::uint64_t most) const override;
    void expect(const std::string& name, std::uint64_t most) const override;
    bool forget(const std::string& name) const override;
    bool isRemote() const override { return true; }
    bool isAway() const override { return description_->isAway(); }

    /// The description's URL with another signature: later requests are made with it.
    void signAnew(const RemoteUrl& url);

  private:
    using Bytes = std::shared_ptr<const std::vector<std::byte>>;
    enum class Stage : std::uint8_t {
        Wanted,
        Asked,
        Here,
        Failed,  ///< until those who waited have seen it
    };
    struct Object {
        Stage stage = Stage::Wanted;
        std::uint64_t most = 0;  ///< bytes
        Bytes bytes{};
        Error error{};            ///< of one that has failed
        std::size_t waiting = 0;  ///< readers; it stays until they have it
        bool saved = false;       ///< on disk, or not to be; somebody has read it
        bool spared = false;      ///< it was its turn to go, and nobody had read it yet
        std::list<std::string>::iterator use{};
    };
    struct Request {
        std::string name;
        std::uint64_t most = 0;
        RequestPace::Time begun{};
    };

    RemoteFolder(std::shared_ptr<RemoteCommons> commons, std::shared_ptr<RemoteFile> description,
                 RemoteUrl url, RemoteEnvironment environment);

    Expected<std::vector<std::byte>> readDescription(std::uint64_t most) const;
    std::string keyOf(const std::string& name) const;
    Bytes fromDisk(const std::string& name, std::uint64_t most) const;
    void toDisk(const std::string& name, const std::vector<std::byte>& bytes) const;
    Error absence() const;
    Expected<std::shared_ptr<const ObjectAccess>> accessTo(const std::string& name) const;
    // With the lock held.
    bool isOut() const;
    void want(const std::string& name, std::uint64_t most) const;
    void keep(const std::string& name, Bytes bytes, bool saved) const;
    void failObject(const std::string& name, const Error& error) const;
    void makeRoom() const;
    std::uint64_t share() const;
    bool hasRoomAhead() const;
    std::vector<Request> requestsDue() const;
    // Without it.
    void send(const std::vector<Request>& requests) const;
    void arrived(const Request& request, PartOrFault result) const;
    void failed(const Request& request, const RequestFault& fault) const;

    const std::shared_ptr<RemoteCommons> commons_;
    const std::shared_ptr<RemoteFile> description_;
    const std::string descriptionName_;
    const std::string identity_;  // of its URL, for the pieces on disk
    const RemoteEnvironment environment_;

    mutable Monitor monitor_;  // guards what follows
    mutable RemoteUrl url_;
    mutable std::map<std::string, Object> objects_;
    mutable std::deque<std::string> order_;  // wanted, the first one first
    mutable std::list<std::string> uses_;    // here, the last used first
    mutable std::set<std::string> refused_;  // when the server was there all the same
    mutable std::uint64_t bytesHere_ = 0;
    mutable std::uint64_t usual_ = 256 << 10;  // bytes of an object, of those that came
    mutable std::size_t underWay_ = 0;
    mutable RequestPace pace_;
    mutable bool isLost_ = false;  // since nobody has seen the server
};

}  // namespace scancast
