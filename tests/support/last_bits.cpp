// SPDX-License-Identifier: Apache-2.0
// The mathematical library of another processor: a quarter of its results differ in the last bit,
// as those of glibc do from one processor to another.  Preloaded (LD_PRELOAD);
// STILLHAND_LAST_BITS=N chooses which, 0 none.
#include <dlfcn.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace {

std::uint64_t seed() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing here sets a variable
  const char* const text = std::getenv("STILLHAND_LAST_BITS");
  return text == nullptr ? 0 : std::strtoull(text, nullptr, 10);
}

// The finaliser of MurmurHash3.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 33)) * 0xff51afd7ed558ccd;
  x = (x ^ (x >> 33)) * 0xc4ceb9fe1a85ec53;
  return x ^ (x >> 33);
}

// The same for y and -y: odd functions stay odd.  Whole results (0, 1) are exact everywhere.
double moved(double y, std::uint64_t function) {
  static const std::uint64_t kSeed = seed();
  if (kSeed == 0 || !std::isfinite(y) || y == std::trunc(y)) return y;
  const auto bits = std::bit_cast<std::uint64_t>(y);
  const std::uint64_t drawn = mixed((bits << 1) ^ mixed(kSeed << 8 | function)) % 8;
  return drawn > 1 ? y : std::bit_cast<double>(drawn == 0 ? bits + 1 : bits - 1);
}

template <typename Function>
Function original(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

using OfOne = double (*)(double);
using OfTwo = double (*)(double, double);
using SineAndCosine = void (*)(double, double*, double*);

}  // namespace

#define STILLHAND_OF_ONE(name, number)                    \
  extern "C" double name(double x) noexcept {             \
    static const auto kOriginal = original<OfOne>(#name); \
    return moved(kOriginal(x), number);                   \
  }
#define STILLHAND_OF_TWO(name, number)                    \
  extern "C" double name(double x, double y) noexcept {   \
    static const auto kOriginal = original<OfTwo>(#name); \
    return moved(kOriginal(x, y), number);                \
  }
STILLHAND_OF_ONE(exp, 1)
STILLHAND_OF_ONE(sin, 2)
STILLHAND_OF_ONE(cos, 3)
STILLHAND_OF_ONE(log, 4)
STILLHAND_OF_ONE(tan, 5)
STILLHAND_OF_ONE(atan, 6)
STILLHAND_OF_ONE(tanh, 7)
STILLHAND_OF_ONE(log10, 8)
STILLHAND_OF_ONE(log1p, 9)
STILLHAND_OF_ONE(expm1, 10)
STILLHAND_OF_ONE(log2, 11)
STILLHAND_OF_ONE(exp2, 12)
STILLHAND_OF_TWO(pow, 13)
STILLHAND_OF_TWO(atan2, 14)
STILLHAND_OF_TWO(hypot, 15)

extern "C" void sincos(double x, double* sine, double* cosine) noexcept {
  static const auto kOriginal = original<SineAndCosine>("sincos");
  kOriginal(x, sine, cosine);
  *sine = moved(*sine, 2);
  *cosine = moved(*cosine, 3);
}
