// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace dseam::program {

/// The folder of --out. Files are written under temporary names; commit() renames all of them at
/// once, so that a run that fails leaves no half-written output, and none of an earlier run mixed
/// with its own.
class OutputFolder {
 public:
  /// Makes the folder and proves that it can be written, before any long work.
  ///
  /// Errors:  throws Failure(kUsage) that names the folder and the fault.
  explicit OutputFolder(std::filesystem::path folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  using Writer = std::function<void(std::ostream&)>;
  /// Writes one file under its temporary name. Throws Failure(kUsage), as when the disk is full.
  void write(const std::string& name, const Writer& writer);
  /// The temporary name of a file that something else fills until commit().
  [[nodiscard]] std::filesystem::path reserve(const std::string& name);
  /// Renames everything that was written, and removes the program's other products from the
  /// folder: those are of an earlier run.
  void commit();

  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }

 private:
  void prove_writable() const;
  [[nodiscard]] std::filesystem::path temporary(const std::string& name) const;

  std::filesystem::path folder_;
  bool made_ = false;  ///< The folder was not there before.
  std::vector<std::string> pending_;
};

}  // namespace dseam::program
