// SPDX-License-Identifier: Apache-2.0
#include "program/support/run_program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace dseam::program::test {
namespace {

std::string quoted(const std::string& argument) {
  std::string text = "'";
  for (const char c : argument) {
    text += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return text + "'";
}

}  // namespace

Outcome run_program(const std::vector<std::string>& arguments) {
  std::string command = DSEAM_PROGRAM;
  for (const std::string& argument : arguments) {
    command += ' ' + quoted(argument);
  }
  FILE* pipe = ::popen((command + " 2>&1 </dev/null").c_str(), "r");
  if (pipe == nullptr) {
    throw std::runtime_error("popen failed");
  }
  Outcome outcome;
  std::array<char, 4096> part{};
  for (std::size_t n = 1; n > 0;) {
    n = std::fread(part.data(), 1, part.size(), pipe);
    outcome.text.append(part.data(), n);
  }
  const int status = ::pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "dseam-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("mkdtemp failed");
  }
  folder_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string ScratchFolder::write(const std::string& name, const std::string& content) const {
  std::ofstream(folder_ / name, std::ios::binary) << content;
  return path(name);
}

std::set<std::string> ScratchFolder::names_in(const std::string& name) const {
  std::set<std::string> names;
  if (std::filesystem::is_directory(folder_ / name)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / name)) {
      names.insert(entry.path().filename().string());
    }
  }
  return names;
}

}  // namespace dseam::program::test
