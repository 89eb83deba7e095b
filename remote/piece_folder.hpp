// Pieces of objects on disk, so that what was fetched once need not be again: in a folder that several programs may share, with
// an end. A piece is a file of its own, named by its object - URL and state, so that another one at the same URL has others - and
// its place; it is written beside its name and renamed, and its checksum goes over all of it: what is broken, by whatever, is
// removed and counts as not there. Where there is no more room, what was not used for longest goes.
//
// Owned by `RemoteFiles`. *Thread safety*: every function may be called from any thread. Place: remote file ↔ **pieces on disk**.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "protocol/error.hpp"
#include "remote/answers.hpp"

namespace scancast {

/// Names an object in its state, 32 digits; empty where a change of it would not be noticed.
std::string pieceKey(std::string_view identity, const ObjectState& state);

/// A piece's file: a head with the checksum, then the bytes.
std::vector<std::byte> packPiece(std::string_view key, std::uint64_t piece, std::span<const std::byte> bytes);
/// The bytes of what packPiece() made of this piece of this object; nullopt for everything else.
std::optional<std::vector<std::byte>> unpackPiece(std::string_view key, std::uint64_t piece,
                                                  std::span<const std::byte> packed);

class PieceFolder {
  public:
    static constexpr std::size_t longestPiece = 1 << 20;

    /// `folder` is made where it is not there; what is in it is counted meanwhile, by a thread of its own. `limit`: bytes. Errors: Io.
    static Expected<std::unique_ptr<PieceFolder>> open(const std::filesystem::path& folder,
                                                       std::uint64_t limit);

    /// Whether it seems to be there.
    bool has(const std::string& key, std::uint64_t piece) const;
    /// As it was saved, and used now.
    std::optional<std::vector<std::byte>> load(const std::string& key, std::uint64_t piece);
    /// As well as it goes: a full disk is no error of whoever looks at a cloud.
    void save(const std::string& key, std::uint64_t piece, std::span<const std::byte> bytes);
    void remove(const std::string& key, std::uint64_t piece);

    /// Whether what was there has been counted.
    bool counted() const { return counted_; }
    std::uint64_t bytes() const { return bytes_; }
    std::uint64_t limit() const { return limit_; }
    std::uint64_t broken() const { return broken_; }

  private:
    PieceFolder(std::filesystem::path folder, std::uint64_t limit)
        : folder_(std::move(folder)), limit_(limit) {}
    std::filesystem::path pathOf(const std::string& key, std::uint64_t piece) const;
    void count(const std::stop_token& stop = {});

    const std::filesystem::path folder_;
    const std::uint64_t limit_;
    std::atomic<std::uint64_t> bytes_{0}, broken_{0}, written_{0};
    std::atomic<std::uint64_t> names_{0};
    std::atomic<bool> counted_{false};
    std::mutex counting_;   // held by who looks at all of them
    std::jthread counter_;  // of those that were there before; last, as it uses the others
};

}  // namespace scancast
