// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "plugins/fix/map/place_types.hpp"

namespace odograph::place_map {

/// The inverted file: descriptors by binary words, which are fixed subsets of their bits, in several tables (locality
/// sensitive hashing, Indyk & Motwani 1998). A query also reads the words that differ in one bit (Lv et al. 2007). No
/// vocabulary is trained or stored.
class WordIndex {
 public:
  static constexpr int kTables = 4, kWordBits = 14;

  WordIndex() { clear(); }
  void clear();
  /// Adds the next descriptor, whose number is the count of those before.
  void add(const Descriptor& descriptor);
  /// Calls each(number) for every descriptor that shares a word; some several times.
  template <class Each>
  void look_up(const Descriptor& descriptor, Each&& each) const {
    for (int table = 0; table < kTables; ++table) {
      const uint32_t word = word_of(descriptor, table);
      for (int flip = -1; flip < kWordBits; ++flip) {
        const uint32_t near = flip < 0 ? word : word ^ (1u << flip);
        for (uint32_t at = heads_[slot(table, near)]; at != kNone;
             at = nexts_[at * kTables + static_cast<size_t>(table)])
          each(at);
      }
    }
  }
  size_t bytes() const { return 4 * (heads_.size() + nexts_.size()); }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;
  static uint32_t word_of(const Descriptor& descriptor, int table);
  static size_t slot(int table, uint32_t word) { return (static_cast<size_t>(table) << kWordBits) + word; }

  std::vector<uint32_t> heads_, nexts_;  // of the chain of each word; nexts_ by descriptor and table
};

}  // namespace odograph::place_map
