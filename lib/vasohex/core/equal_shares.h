#pragma once
/// \file Equal parts of a quantity that is known at places.

#include <cstddef>
#include <vector>

namespace vasohex {

/// Between place `index` and the next one, `part` of the way.
struct Between {
  std::size_t index = 0;
  double part = 0;
};

/// Where a quantity summed up to each of n >= 2 places, ascending from 0, passes 1, 2, ... `count` - 1 of `count`
/// equal shares of the whole; linear between places.
inline std::vector<Between> equal_shares(const std::vector<double>& sums, int count) {
  std::vector<Between> all;
  std::size_t index = 0;
  for (int i = 1; i < count; ++i) {
    const double wanted = sums.back() * i / count;
    while (sums[index + 1] < wanted) {
      ++index;
    }
    all.push_back({index, (wanted - sums[index]) / (sums[index + 1] - sums[index])});
  }
  return all;
}

}  // namespace vasohex
