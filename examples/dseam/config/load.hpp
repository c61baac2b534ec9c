// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "config/key.hpp"

namespace dseam::program {

/// Sets the keys that the file names. The file is checked as a whole: every unknown key, wrong type
/// and value out of range becomes one line of the failure, with its line number and what is
/// allowed.
///
/// Errors:  throws Failure(kUsage), and Failure(kUsage) too where the file cannot be read.
void load_config(const std::filesystem::path& file, std::vector<Key>& keys);

/// Sets one key from a command line's `section.name=value`, checked like a file's.
void set_key(const std::string& assignment, std::vector<Key>& keys);

/// Writes every key with its comment, unit, range and present value, as a file that loads again.
void print_config(const std::vector<Key>& keys, std::ostream& out);

}  // namespace dseam::program
