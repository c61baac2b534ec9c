// SPDX-License-Identifier: Apache-2.0
#include "program/support/running_program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <stdexcept>

namespace dseam::program::test {
namespace {

double now_s() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

std::vector<char*> words_of(std::vector<std::string>& arguments) {
  std::vector<char*> words;
  for (std::string& argument : arguments) {
    words.push_back(argument.data());
  }
  words.push_back(nullptr);
  return words;
}

}  // namespace

RunningProgram::RunningProgram(const std::vector<std::string>& arguments) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) {
    throw std::runtime_error("pipe failed");
  }
  std::vector<std::string> all = arguments;
  all.insert(all.begin(), DSEAM_PROGRAM);
  const std::vector<char*> words = words_of(all);
  child_ = ::fork();
  if (child_ == 0) {
    (void)::dup2(ends[1], STDOUT_FILENO);
    (void)::dup2(ends[1], STDERR_FILENO);
    (void)::close(ends[0]);
    (void)::execv(words.front(), words.data());
    ::_exit(127);
  }
  (void)::close(ends[1]);
  pipe_ = ends[0];
}

RunningProgram::~RunningProgram() {
  (void)::close(pipe_);
  if (child_ > 0) {
    (void)::kill(child_, SIGKILL);
    (void)::waitpid(child_, nullptr, 0);
  }
}

bool RunningProgram::read_some() {
  std::array<char, 4096> part{};
  const ssize_t n = ::read(pipe_, part.data(), part.size());
  outcome_.text.append(part.data(), n > 0 ? static_cast<std::size_t>(n) : 0);
  return n > 0;
}

bool RunningProgram::writes(const std::string& text, int times) {
  const auto found = [&] {
    std::size_t at = 0;
    for (int i = 0; i < times && at != std::string::npos; ++i) {
      at = outcome_.text.find(text, at == 0 ? 0 : at + 1);
    }
    return at != std::string::npos;
  };
  while (!found()) {
    if (!read_some()) {
      return false;
    }
  }
  return true;
}

void RunningProgram::interrupt() {
  kept_waiting_s_ = seconds_kept_waiting();
  interrupted_s_ = now_s();
  (void)::kill(child_, SIGINT);
}

Outcome RunningProgram::wait() {
  while (read_some()) {
  }
  siginfo_t ended{};
  (void)::waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOWAIT);
  seconds_to_end_ = now_s() - interrupted_s_ - (seconds_kept_waiting() - kept_waiting_s_);
  int status = 0;
  (void)::waitpid(child_, &status, 0);
  child_ = -1;
  outcome_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome_;
}

double RunningProgram::seconds_kept_waiting() const {
  double run_ns = 0.0;
  double wait_ns = 0.0;
  std::ifstream("/proc/" + std::to_string(child_) + "/schedstat") >> run_ns >> wait_ns;
  return 1e-9 * wait_ns;
}

}  // namespace dseam::program::test
