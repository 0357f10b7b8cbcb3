// SPDX-License-Identifier: Apache-2.0
#include "plugins/fix/map/word_index.hpp"

namespace odograph::place_map {

void WordIndex::clear() {
  heads_.assign(static_cast<size_t>(kTables) << kWordBits, kNone);
  nexts_.clear();
}

uint32_t WordIndex::word_of(const Descriptor& descriptor, int table) {
  // The pattern is random, so that any bits are as good as others: consecutive ones.
  uint32_t word = 0;
  for (int bit = 0; bit < kWordBits; ++bit) {
    const auto at = static_cast<size_t>(table * kWordBits + bit);
    word |= static_cast<uint32_t>(descriptor[at / 64] >> (at % 64) & 1) << bit;
  }
  return word;
}

void WordIndex::add(const Descriptor& descriptor) {
  const auto number = static_cast<uint32_t>(nexts_.size() / kTables);
  for (int table = 0; table < kTables; ++table) {
    uint32_t& head = heads_[slot(table, word_of(descriptor, table))];
    nexts_.push_back(head);
    head = number;
  }
}

}  // namespace odograph::place_map
