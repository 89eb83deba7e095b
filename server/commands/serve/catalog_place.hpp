// Where the clouds of --catalog are: a folder (catalog_folder.hpp) or a URL (catalog_url.hpp). Looked at again and again, because
// clouds come and go; and of what is there, what is served.
//
// Owned by the lookout (catalog_lookout.hpp), and used on its thread: neither has to answer.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "remote/remote_files.hpp"

namespace scancast {

class CatalogPlace {
  public:
    virtual ~CatalogPlace() = default;
    /// Looks; whether files(), of which there are to be `most`, are others than before, or isAnew(). A place that cannot be read
    /// changes nothing, and is told of once.
    virtual bool look(std::size_t most) = 0;
    /// In byte order of the names; no two of them have the same id.
    virtual const std::vector<std::filesystem::path>& files() const = 0;
    /// The last look found another file under the name of one that was there: what could not be served may be whole now.
    virtual bool isAnew() const { return false; }
};

/// `place` is a folder, or a URL that RemoteListing::create() takes.
std::unique_ptr<CatalogPlace> catalogPlace(const std::filesystem::path& place,
                                           std::shared_ptr<RemoteFiles> remote,
                                           std::function<void(const std::string&)> onNote);

/// A cloud that could be served.
struct CatalogCandidate {
    std::filesystem::path file;  ///< or URL
    std::string shown, name;
};

/// Which of them are: one for each id, and no more than may be. The first ones in their order, whatever was there before, so that
/// servers that look at the same place serve the same clouds.
class CatalogChoice {
  public:
    CatalogChoice(std::string place, std::function<void(const std::string&)> onNote)
        : place_(std::move(place)), onNote_(std::move(onNote)) {}
    std::vector<std::filesystem::path> choose(std::vector<CatalogCandidate> candidates, std::size_t most);

  private:
    std::string place_;
    std::function<void(const std::string&)> onNote_;
    bool isFull_ = false;
    std::set<std::string> namesakes_;  ///< that were left out, and told
};

}  // namespace scancast
