// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdio>
#include <thread>

namespace dseam::program {

/// The first arming condition: somebody who lets the weld begin, and may end it at any time.
class OperatorEnable {
 public:
  OperatorEnable() = default;
  OperatorEnable(const OperatorEnable&) = delete;
  OperatorEnable& operator=(const OperatorEnable&) = delete;
  virtual ~OperatorEnable() = default;

  /// From now on an enable counts; one that was given before does not.
  virtual void ask() noexcept = 0;
  /// Context: the cycle; never waits.
  [[nodiscard]] virtual bool held() const noexcept = 0;
};

/// Nobody is asked: for a simulated robot, and where the user waived it by name.
class WaivedEnable final : public OperatorEnable {
 public:
  void ask() noexcept override { asked_ = true; }
  [[nodiscard]] bool held() const noexcept override { return asked_; }

 private:
  bool asked_ = false;
};

/// Enter on a terminal gives the enable, Enter once more takes it back, for good. So does the end
/// of the terminal.
class TerminalEnable final : public OperatorEnable {
 public:
  /// Reads `input`, a descriptor that poll() takes, and tells the operator on `screen`.
  TerminalEnable(int input, std::FILE* screen);
  ~TerminalEnable() override;

  void ask() noexcept override { asked_ = true; }
  [[nodiscard]] bool held() const noexcept override { return held_; }

 private:
  void listen();
  /// Waits for a line; false when the terminal or this object came to its end first.
  bool wait_for_line();
  void forget_early_lines();

  int input_;
  std::FILE* screen_;
  std::atomic<bool> asked_{false};
  std::atomic<bool> held_{false};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace dseam::program
