// The words for scans that end too early, or are damaged, and are read all the same, because somebody asked for what is whole of them
// (ImportOptions::recover). Pure functions. Pipeline: file → **reader** → points; notes of PointSource.
#pragma once

#include <cstdint>
#include <string>

namespace scancast {

/// "of the 1,000 points that it promises, 400 are whole and were read; 600 (60.0 %) are lost". `there` is less than `promised`.
std::string lostShare(std::uint64_t promised, std::uint64_t there);

/// "it ends too early: of the 1,000 points that it promises, 400 are whole and were read; 600 (60.0 %) are lost". `what`
/// is "it", or a part of it. `there` is less than `promised`.
std::string lostPoints(const std::string& what, std::uint64_t promised, std::uint64_t there);

/// "x.las: " and the words, from "/scans/x.las": notes are read by people who know where their files are.
std::string noteOf(const std::string& file, const std::string& words);

}  // namespace scancast
