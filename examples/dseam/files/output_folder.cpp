// SPDX-License-Identifier: Apache-2.0
#include "files/output_folder.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "failure.hpp"

namespace dseam::program {
namespace {

namespace fs = std::filesystem;

constexpr std::array kProducts{"seam.csv",    "path.csv",    "poses.json",    "merged.ply",
                               "report.json", "report.html", "hand_eye.json", "can.log"};

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Failure(ExitCode::kUsage, path.string() + ": cannot be written: " + what);
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  made_ = fs::create_directories(folder_, error);
  if (error) {
    fail(folder_, error.message());
  }
  prove_writable();
}

/// Permissions alone do not tell: a file system may be read-only, and root passes every check.
void OutputFolder::prove_writable() const {
  const fs::path probe = temporary("probe");
  if (!std::ofstream(probe)) {
    const std::string why = std::strerror(errno);
    std::error_code ignored;
    if (made_) {
      fs::remove(folder_, ignored);
    }
    fail(folder_, why);
  }
  fs::remove(probe);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  for (const std::string& name : pending_) {
    fs::remove(temporary(name), ignored);
  }
  if (made_) {
    fs::remove(folder_, ignored);  // Only when it is empty: nothing was committed.
  }
}

fs::path OutputFolder::temporary(const std::string& name) const {
  return folder_ / ("." + name + "." + std::to_string(::getpid()) + ".tmp");
}

fs::path OutputFolder::reserve(const std::string& name) {
  pending_.push_back(name);
  return temporary(name);
}

void OutputFolder::write(const std::string& name, const Writer& writer) {
  std::ofstream out(reserve(name), std::ios::binary);
  writer(out);
  out.close();
  if (!out) {
    fail(path(name), std::strerror(errno));
  }
}

void OutputFolder::commit() {
  for (const std::string& name : pending_) {
    std::error_code error;
    if (fs::is_directory(path(name), error)) {
      fail(path(name), "a folder of that name is in the way");  // Before the first is renamed.
    }
  }
  for (const std::string& name : pending_) {
    std::error_code error;
    fs::rename(temporary(name), path(name), error);
    if (error) {
      fail(path(name), error.message());
    }
  }
  for (const char* name : kProducts) {
    std::error_code ignored;
    if (std::find(pending_.begin(), pending_.end(), name) == pending_.end()) {
      fs::remove(path(name), ignored);  // Of an earlier run: it would contradict this one.
    }
  }
  pending_.clear();
}

}  // namespace dseam::program
