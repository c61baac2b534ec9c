// SPDX-License-Identifier: Apache-2.0
// Reset code of a bare Cortex-M7, and the little that a freestanding link needs. There is no heap:
// whatever in lib/ asked for one would end in an undefined `_sbrk` or `operator new`.
#include "start.hpp"

#include <cstddef>
#include <cstdint>

extern "C" {
extern std::uint32_t _stack_top, _data_load, _data_start, _data_end, _bss_start, _bss_end;
extern void (*_init_array_start[])();
extern void (*_init_array_end[])();
}

namespace dseam::target {
namespace {

constexpr int kSemihostWrite0 = 0x04;
constexpr int kSemihostExitExtended = 0x20;
constexpr std::uint32_t kApplicationExit = 0x20026;

int semihost(int operation, const void* argument) noexcept {
  register int r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

void fault() noexcept { quit(99); }

}  // namespace

void print(const char* text) noexcept { semihost(kSemihostWrite0, text); }

void quit(int code) noexcept {
  const std::uint32_t arguments[2] = {kApplicationExit, static_cast<std::uint32_t>(code)};
  semihost(kSemihostExitExtended, arguments);
  for (;;) {
  }
}

}  // namespace dseam::target

extern "C" {

[[noreturn]] void abort() { dseam::target::quit(98); }

// The linker keeps the deleting destructors of the hal interfaces' users; nobody may call one.
[[noreturn]] void __cxa_pure_virtual() { dseam::target::quit(97); }

[[noreturn]] void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFU << 20U;  // The FPU on.
  asm volatile("dsb\nisb");
  for (std::uint32_t *from = &_data_load, *to = &_data_start; to < &_data_end;) {
    *to++ = *from++;
  }
  for (std::uint32_t* to = &_bss_start; to < &_bss_end;) {
    *to++ = 0;
  }
  for (auto* init = _init_array_start; init < _init_array_end; ++init) {
    (*init)();
  }
  dseam::target::quit(dseam::target::run_checks());
}

[[gnu::section(".vectors"), gnu::used]] void* const kVectors[7] = {
    &_stack_top,
    reinterpret_cast<void*>(reset),
    reinterpret_cast<void*>(dseam::target::fault),
    reinterpret_cast<void*>(dseam::target::fault),
    reinterpret_cast<void*>(dseam::target::fault),
    reinterpret_cast<void*>(dseam::target::fault),
    reinterpret_cast<void*>(dseam::target::fault)};
}
