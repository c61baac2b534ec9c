// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target over each file of a corpus and over seeded mutations of it, without libFuzzer.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include "dseam/base/random.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kMutationsPerFile = 3000;

Bytes bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::size_t place(dseam::Pcg32& random, const Bytes& bytes) {
  return random.below(static_cast<std::uint32_t>(bytes.size()));
}

/// One of: flip a bit, set a byte, cut the end, repeat or remove a stretch.
void mutate(dseam::Pcg32& random, Bytes& bytes) {
  if (bytes.empty()) {
    bytes.push_back(static_cast<std::uint8_t>(random.below(256)));
    return;
  }
  const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(place(random, bytes));
  const auto length = std::min<std::ptrdiff_t>(1 + random.below(16), bytes.end() - at);
  switch (random.below(5)) {
    case 0:
      *at = static_cast<std::uint8_t>(*at ^ (1U << random.below(8)));
      break;
    case 1:
      *at = static_cast<std::uint8_t>(random.below(256));
      break;
    case 2:
      bytes.erase(at, bytes.end());
      break;
    case 3: {
      const Bytes stretch(at, at + length);
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(place(random, bytes)),
                   stretch.begin(), stretch.end());
      break;
    }
    default:
      bytes.erase(at, at + length);
  }
}

void run_with_mutations(const Bytes& seed, dseam::Pcg32& random) {
  LLVMFuzzerTestOneInput(seed.data(), seed.size());
  for (int i = 0; i < kMutationsPerFile; ++i) {
    Bytes bytes = seed;
    for (std::uint32_t n = 1 + random.below(4); n > 0; --n) {
      mutate(random, bytes);
    }
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: " << argv[0] << " CORPUS\n";
    return 2;
  }
  dseam::Pcg32 random(1);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) {
    run_with_mutations(bytes_of(file), random);
  }
  std::cout << files.size() << " files, " << kMutationsPerFile << " mutations of each\n";
  return files.empty() ? 1 : 0;
}
