// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

/// Eight numbers that go through the same arithmetic at once.
///
/// One AVX register, two of SSE or NEON, plain registers on a microcontroller: the compiler's own
/// vectors do it, without intrinsics. Every operation is exact or correctly rounded lane by lane,
/// so the width of the registers cannot change a bit of a result.
namespace dseam::lanes {

inline constexpr std::size_t kLanes = 8;

#if defined(__AVX__)
inline constexpr std::size_t kPartLanes = 8;
#else
inline constexpr std::size_t kPartLanes = 4;
#endif
typedef float FloatPart __attribute__((vector_size(kPartLanes * sizeof(float))));
// Of int, as comparisons give it: std::int32_t is another type, long, on a Cortex-M.
static_assert(sizeof(int) == sizeof(std::int32_t));
typedef int IntPart __attribute__((vector_size(kPartLanes * sizeof(int))));

template <typename Part>
struct Lanes {
#if defined(__AVX__)
  Part low;

  template <typename Op, typename... Others>
  [[gnu::always_inline]] static auto each(Op op, const Others&... others) noexcept {
    return Lanes<decltype(op(others.low...))>{op(others.low...)};
  }
#else
  Part low;
  Part high;

  template <typename Op, typename... Others>
  [[gnu::always_inline]] static auto each(Op op, const Others&... others) noexcept {
    return Lanes<decltype(op(others.low...))>{op(others.low...), op(others.high...)};
  }
#endif
  [[gnu::always_inline]] auto operator[](std::size_t i) const noexcept {
#if defined(__AVX__)
    return low[i];
#else
    return i < kPartLanes ? low[i] : high[i - kPartLanes];
#endif
  }
};

using FloatLanes = Lanes<FloatPart>;
using IntLanes = Lanes<IntPart>;  ///< Also the mask of a comparison: all bits set, or none.

// One line for each operator; `each` spreads it over the parts.
#define DSEAM_LANES_OPERATOR(type, result, op)                                          \
  [[gnu::always_inline, nodiscard]] inline result operator op(const type& a,            \
                                                              const type& b) noexcept { \
    return type::each([](auto p, auto q) { return p op q; }, a, b);                     \
  }
DSEAM_LANES_OPERATOR(FloatLanes, FloatLanes, +)
DSEAM_LANES_OPERATOR(FloatLanes, FloatLanes, -)
DSEAM_LANES_OPERATOR(FloatLanes, FloatLanes, *)
DSEAM_LANES_OPERATOR(FloatLanes, FloatLanes, /)
DSEAM_LANES_OPERATOR(FloatLanes, IntLanes, <)
DSEAM_LANES_OPERATOR(FloatLanes, IntLanes, <=)
DSEAM_LANES_OPERATOR(FloatLanes, IntLanes, >)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, +)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, -)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, *)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, &)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, |)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, ^)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, <)
DSEAM_LANES_OPERATOR(IntLanes, IntLanes, ==)
#undef DSEAM_LANES_OPERATOR

#if defined(__SSE2__) || defined(__ARM_NEON)
#define DSEAM_LANES_IN_REGISTERS
#endif
/// The same part anywhere in memory. By memcpy, some compilers would go through the stack; where no
/// register holds a part, though, GCC takes it apart and forgets that it may alias.
template <typename Part>
struct InMemory {
  typedef Part Anywhere __attribute__((aligned(4), may_alias));
};
template <typename T, typename E>
[[gnu::always_inline, nodiscard]] inline T load_lanes(const E* from) noexcept {
  static_assert(sizeof(T) == kLanes * sizeof *from);
#if defined(DSEAM_LANES_IN_REGISTERS)
  using Part = decltype(T::low);
  const auto* parts = reinterpret_cast<const typename InMemory<Part>::Anywhere*>(from);
#if defined(__AVX__)
  return {*parts};
#else
  return {parts[0], parts[1]};
#endif
#else
  using Number = std::remove_reference_t<decltype(T{}[0])>;
  T lanes;
  for (std::size_t i = 0; i < kPartLanes; ++i) {
    lanes.low[i] = static_cast<Number>(from[i]);
    lanes.high[i] = static_cast<Number>(from[kPartLanes + i]);
  }
  return lanes;
#endif
}
[[gnu::always_inline, nodiscard]] inline FloatLanes load(const float* from) noexcept {
  return load_lanes<FloatLanes>(from);
}
[[gnu::always_inline, nodiscard]] inline IntLanes load(const std::int32_t* from) noexcept {
  return load_lanes<IntLanes>(from);
}
template <typename Part, typename E>
[[gnu::always_inline]] inline void store(const Lanes<Part>& lanes, E* to) noexcept {
  static_assert(sizeof lanes == kLanes * sizeof *to);
#if defined(DSEAM_LANES_IN_REGISTERS)
  auto* parts = reinterpret_cast<typename InMemory<Part>::Anywhere*>(to);
  parts[0] = lanes.low;
#if !defined(__AVX__)
  parts[1] = lanes.high;
#endif
#else
  for (std::size_t i = 0; i < kLanes; ++i) {
    to[i] = static_cast<E>(lanes[i]);
  }
#endif
}
[[gnu::always_inline, nodiscard]] inline FloatLanes splat(float value) noexcept {
  return FloatLanes::each([value](auto zero) { return value - zero; }, FloatLanes{});
}
template <std::signed_integral T>
[[gnu::always_inline, nodiscard]] inline IntLanes splat(T value) noexcept {
  static_assert(sizeof value == sizeof(int));
  return IntLanes::each([value](auto zero) { return static_cast<int>(value) - zero; }, IntLanes{});
}
/// `a` where the mask is set, else `b`.
template <typename Part>
[[gnu::always_inline, nodiscard]] inline Lanes<Part> select(const IntLanes& mask,
                                                            const Lanes<Part>& a,
                                                            const Lanes<Part>& b) noexcept {
  return Lanes<Part>::each([](auto m, auto p, auto q) { return m ? p : q; }, mask, a, b);
}
/// The second argument where either is not a number.
[[gnu::always_inline, nodiscard]] inline FloatLanes min(const FloatLanes& a,
                                                        const FloatLanes& b) noexcept {
  return FloatLanes::each([](auto p, auto q) { return p < q ? p : q; }, a, b);
}
[[gnu::always_inline, nodiscard]] inline FloatLanes max(const FloatLanes& a,
                                                        const FloatLanes& b) noexcept {
  return FloatLanes::each([](auto p, auto q) { return p > q ? p : q; }, a, b);
}
[[gnu::always_inline, nodiscard]] inline FloatLanes to_float(const IntLanes& a) noexcept {
  return IntLanes::each([](auto p) { return __builtin_convertvector(p, FloatPart); }, a);
}
/// Towards zero; the caller has checked the range.
[[gnu::always_inline, nodiscard]] inline IntLanes to_int(const FloatLanes& a) noexcept {
  return FloatLanes::each([](auto p) { return __builtin_convertvector(p, IntPart); }, a);
}
[[gnu::always_inline, nodiscard]] inline IntLanes widen(const std::uint16_t* from) noexcept {
  typedef std::uint16_t ShortPart __attribute__((vector_size(kPartLanes * sizeof(std::uint16_t))));
  Lanes<ShortPart> narrow;
  std::memcpy(&narrow, from, sizeof narrow);
  return Lanes<ShortPart>::each([](auto p) { return __builtin_convertvector(p, IntPart); }, narrow);
}
/// By way of 16 bits, which the compiler does at once; bytes it would take one by one.
[[gnu::always_inline, nodiscard]] inline IntLanes widen(const std::uint8_t* from) noexcept {
  static_assert(std::endian::native == std::endian::little);
  typedef std::uint8_t Bytes __attribute__((vector_size(2 * kLanes)));
  typedef std::uint64_t Words __attribute__((vector_size(2 * kLanes)));
  std::uint64_t eight;
  std::memcpy(&eight, from, sizeof eight);
  const auto narrow = reinterpret_cast<Bytes>(Words{eight, 0});
  const Bytes zero{};
  const Bytes wide =
      __builtin_shufflevector(narrow, zero, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  std::uint16_t shorts[kLanes];
  std::memcpy(shorts, &wide, sizeof shorts);
  return widen(shorts);
}
/// The greatest whole number that is not above; the caller has checked the range.
[[gnu::always_inline, nodiscard]] inline FloatLanes floor(const FloatLanes& a) noexcept {
#if defined(__AVX__)
  constexpr int kDownQuietly = 9;
  return {__builtin_ia32_roundps256(a.low, kDownQuietly)};
#else
  const IntLanes towards_zero = to_int(a);
  return to_float(towards_zero + (to_float(towards_zero) > a));  // A mask that is set counts as -1.
#endif
}
/// The same bits.
[[gnu::always_inline, nodiscard]] inline FloatLanes as_floats(const IntLanes& a) noexcept {
  FloatLanes floats;
  std::memcpy(&floats, &a, sizeof floats);
  return floats;
}
[[gnu::always_inline, nodiscard]] inline IntLanes as_ints(const FloatLanes& a) noexcept {
  IntLanes ints;
  std::memcpy(&ints, &a, sizeof ints);
  return ints;
}
[[gnu::always_inline, nodiscard]] inline FloatLanes magnitude(const FloatLanes& a) noexcept {
  return as_floats(as_ints(a) & splat(0x7FFFFFFF));
}
template <int kShift>
[[gnu::always_inline, nodiscard]] inline IntLanes shift_left(const IntLanes& a) noexcept {
  return IntLanes::each([](auto p) { return p << kShift; }, a);
}
/// Also of zero, which the difference from zero is not.
[[gnu::always_inline, nodiscard]] inline FloatLanes negated(const FloatLanes& a) noexcept {
  return splat(-0.0F) - a;
}
/// Of what is not negative.
template <int kShift>
[[gnu::always_inline, nodiscard]] inline IntLanes shift_right(const IntLanes& a) noexcept {
  return IntLanes::each([](auto p) { return p >> kShift; }, a);
}
/// `a` where the mask is set, else zero.
[[gnu::always_inline, nodiscard]] inline FloatLanes keep(const IntLanes& mask,
                                                         const FloatLanes& a) noexcept {
  return as_floats(as_ints(a) & mask);
}
[[gnu::always_inline, nodiscard]] inline FloatLanes sqrt(const FloatLanes& a) noexcept {
#if defined(__AVX__)
  return {__builtin_ia32_sqrtps256(a.low)};
#elif defined(__SSE2__)
  return {__builtin_ia32_sqrtps(a.low), __builtin_ia32_sqrtps(a.high)};
#else
  float each[kLanes];
  store(a, each);
  for (float& value : each) {
    value = __builtin_sqrtf(value);
  }
  return load(each);
#endif
}
/// Bit i is set where lane i of the mask is.
[[gnu::always_inline, nodiscard]] inline std::uint32_t bits(const IntLanes& mask) noexcept {
#if defined(__AVX__)
  FloatPart signs;
  std::memcpy(&signs, &mask.low, sizeof signs);
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(signs));
#elif defined(__SSE2__)
  FloatPart low;
  FloatPart high;
  std::memcpy(&low, &mask.low, sizeof low);
  std::memcpy(&high, &mask.high, sizeof high);
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps(low) |
                                    (__builtin_ia32_movmskps(high) << 4));
#else
  const IntPart kLow = {1, 2, 4, 8};
  const IntPart kHigh = {16, 32, 64, 128};
  const IntPart set = (mask.low & kLow) | (mask.high & kHigh);
  return static_cast<std::uint32_t>((set[0] | set[1]) | (set[2] | set[3]));
#endif
}
[[gnu::always_inline, nodiscard]] inline float largest(const FloatLanes& a) noexcept {
  typedef float Four __attribute__((vector_size(16)));
  Four half[2];
  std::memcpy(half, &a, sizeof half);
  const Four most = half[0] > half[1] ? half[0] : half[1];
  const float even = most[0] > most[2] ? most[0] : most[2];
  const float odd = most[1] > most[3] ? most[1] : most[3];
  return even > odd ? even : odd;
}

[[gnu::always_inline, nodiscard]] inline float least(const FloatLanes& a) noexcept {
  return -largest(splat(0.0F) - a);
}
/// Each lane with all before it.
[[gnu::always_inline, nodiscard]] inline IntLanes running_sum(IntLanes a) noexcept {
#if defined(__AVX__)
  const IntPart zero{};
  a.low = a.low + __builtin_shufflevector(zero, a.low, 0, 8, 9, 10, 0, 12, 13, 14);
  a.low = a.low + __builtin_shufflevector(zero, a.low, 0, 0, 8, 9, 0, 0, 12, 13);
  a.low = a.low + __builtin_shufflevector(zero, a.low, 0, 0, 0, 0, 11, 11, 11, 11);
#else
  const auto in_part = [](IntPart p) {
    const IntPart zero{};
    p = p + __builtin_shufflevector(zero, p, 0, 4, 5, 6);
    return p + __builtin_shufflevector(zero, p, 0, 0, 4, 5);
  };
  a.low = in_part(a.low);
  a.high = in_part(a.high) + __builtin_shufflevector(a.low, a.low, 3, 3, 3, 3);
#endif
  return a;
}
/// A mask with lane `i` alone.
[[gnu::always_inline, nodiscard]] inline IntLanes is_lane(std::size_t i) noexcept {
  constexpr std::int32_t kNumbers[kLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  return load(kNumbers) == splat(static_cast<std::int32_t>(i));
}

}  // namespace dseam::lanes
