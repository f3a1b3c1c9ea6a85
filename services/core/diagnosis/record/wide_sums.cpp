// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/record/wide_sums.hpp"

#include <algorithm>
#include <array>

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kSums = 8;  // side by side, of one product

// As many numbers as a register holds, read from anywhere.
template <std::size_t L>
struct Register {
  using Type
      [[gnu::vector_size(L * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] =
          double;
};

template <std::size_t L>
[[gnu::always_inline]] inline const typename Register<L>::Type& at(const double* x) {
  return *reinterpret_cast<const typename Register<L>::Type*>(x);
}

// kSums numbers in registers of L.
template <std::size_t L>
struct Sums {
  typename Register<L>::Type part[kSums / L]{};

  [[gnu::always_inline]] void add_product(const double* a, const double* b) {
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kSums / L; ++i) part[i] += at<L>(a + i * L) * at<L>(b + i * L);
  }
  [[gnu::always_inline]] void add_scaled(double factor, const double* x) {
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kSums / L; ++i) part[i] += factor * at<L>(x + i * L);
  }
  [[gnu::always_inline]] double lane(std::size_t l) const { return part[l / L][l % L]; }
  [[gnu::always_inline]] double total() const {
    return ((lane(0) + lane(4)) + (lane(1) + lane(5))) +
           ((lane(2) + lane(6)) + (lane(3) + lane(7)));
  }
};

// Two columns with two others: each number that is read is used twice.
template <std::size_t L>
[[gnu::always_inline]] inline std::array<double, 4> products_of_pairs(
    const double* a0, const double* a1, const double* b0, const double* b1, std::size_t rows) {
  Sums<L> s00, s01, s10, s11;
  std::size_t n = 0;
  for (; n + kSums <= rows; n += kSums) {
    s00.add_product(a0 + n, b0 + n);
    s01.add_product(a0 + n, b1 + n);
    s10.add_product(a1 + n, b0 + n);
    s11.add_product(a1 + n, b1 + n);
  }
  std::array<double, 4> sums{s00.total(), s01.total(), s10.total(), s11.total()};
  for (; n < rows; ++n) {
    sums[0] += a0[n] * b0[n];
    sums[1] += a0[n] * b1[n];
    sums[2] += a1[n] * b0[n];
    sums[3] += a1[n] * b1[n];
  }
  return sums;
}

template <std::size_t L>
[[gnu::always_inline]] inline void write_products_in(const ColumnPointers& columns,
                                                     std::size_t rows, Eigen::Index from,
                                                     Eigen::MatrixXd& products) {
  const auto count = static_cast<Eigen::Index>(columns.size());
  // From the last pair on; a first column that is left over is taken twice.
  for (Eigen::Index i1 = count - 1; i1 >= from; i1 -= 2) {
    const Eigen::Index i0 = std::max<Eigen::Index>(i1 - 1, 0);
    for (Eigen::Index j1 = i1; j1 >= 0; j1 -= 2) {
      const Eigen::Index j0 = std::max<Eigen::Index>(j1 - 1, 0);
      const auto column = [&](Eigen::Index c) { return columns[static_cast<std::size_t>(c)]; };
      const std::array<double, 4> sums =
          products_of_pairs<L>(column(i0), column(i1), column(j0), column(j1), rows);
      const auto write = [&](Eigen::Index i, Eigen::Index j, double sum) {
        if (i < from) return;
        products(i, j) = products(j, i) = sum;
      };
      write(i0, j0, sums[0]);
      write(i0, j1, sums[1]);
      write(i1, j0, sums[2]);
      write(i1, j1, sums[3]);
    }
  }
}

template <std::size_t L>
[[gnu::always_inline]] inline void filter_in(std::span<const double> taps, std::span<double> x) {
  constexpr std::size_t kAtOnce = 2 * kSums;
  const std::size_t longest = taps.size() - 1;
  // From the end: what a sample needs is still unfiltered.
  std::size_t end = x.size();
  for (; end >= longest + kAtOnce; end -= kAtOnce) {
    double* const newest = x.data() + end - kAtOnce;
    Sums<L> first, second;
    for (std::size_t k = 0; k <= longest; ++k) {
      first.add_scaled(taps[k], newest - k);
      second.add_scaled(taps[k], newest + kSums - k);
    }
    for (std::size_t l = 0; l < kSums; ++l) {
      newest[l] = first.lane(l);
      newest[kSums + l] = second.lane(l);
    }
  }
  while (end-- > 0) {
    double sum = 0.0;
    for (std::size_t k = 0; k <= std::min(longest, end); ++k) sum += taps[k] * x[end - k];
    x[end] = sum;
  }
}

constexpr std::size_t kLanes = 2;  // of what every processor of the build has

#if defined(__x86_64__)
enum class Width { kUsual, kAvx, kAvx512 };

Width width() {
  static const Width kWidth = [] {
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f")) return Width::kAvx512;
    return __builtin_cpu_supports("avx") ? Width::kAvx : Width::kUsual;
  }();
  return kWidth;
}

[[gnu::target("avx")]] void write_products_avx(const ColumnPointers& columns, std::size_t rows,
                                               Eigen::Index from, Eigen::MatrixXd& products) {
  write_products_in<4>(columns, rows, from, products);
}
[[gnu::target("avx512f")]] void write_products_avx512(const ColumnPointers& columns,
                                                      std::size_t rows, Eigen::Index from,
                                                      Eigen::MatrixXd& products) {
  write_products_in<8>(columns, rows, from, products);
}
[[gnu::target("avx")]] void filter_avx(std::span<const double> taps, std::span<double> x) {
  filter_in<4>(taps, x);
}
[[gnu::target("avx512f")]] void filter_avx512(std::span<const double> taps, std::span<double> x) {
  filter_in<8>(taps, x);
}
#endif

}  // namespace

void append_columns(const Eigen::MatrixXd& columns, Eigen::Index first, ColumnPointers& pointers) {
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    pointers.push_back(columns.col(c).data() + first);
  }
}

void write_products(const ColumnPointers& columns, std::size_t rows, Eigen::Index from,
                    Eigen::MatrixXd& products) {
#if defined(__x86_64__)
  if (width() == Width::kAvx512) return write_products_avx512(columns, rows, from, products);
  if (width() == Width::kAvx) return write_products_avx(columns, rows, from, products);
#endif
  write_products_in<kLanes>(columns, rows, from, products);
}

void filter_in_place(std::span<const double> taps, std::span<double> x) {
#if defined(__x86_64__)
  if (width() == Width::kAvx512) return filter_avx512(taps, x);
  if (width() == Width::kAvx) return filter_avx(taps, x);
#endif
  filter_in<kLanes>(taps, x);
}

}  // namespace stillhand::diagnosis
