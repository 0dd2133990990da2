// Measures the limits of one core, as a worker: `machine copy BYTES`, `machine fma 0`, `machine divide 0`, `machine root 0`.
//
// The worker prints "ready". "run N" repeats its operation N times; "write FILE" writes the amount of one repetition: bytes
// read and written, or floating-point operations.
#include <immintrin.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#if defined(__AVX512F__)
using Vector = __m512d;
inline Vector all(double a) { return _mm512_set1_pd(a); }
inline Vector root(Vector a) { return _mm512_sqrt_pd(a); }
#elif defined(__AVX__)
using Vector = __m256d;
inline Vector all(double a) { return _mm256_set1_pd(a); }
inline Vector root(Vector a) { return _mm256_sqrt_pd(a); }
#else
using Vector = __m128d;
inline Vector all(double a) { return _mm_set1_pd(a); }
inline Vector root(Vector a) { return _mm_sqrt_pd(a); }
#endif

constexpr int LANES = sizeof(Vector) / sizeof(double);
// Exceeds the latency of an FMA times the number of FMA units, and leaves registers for its other operands: without AVX-512 there are 16 in all.
#if defined(__AVX512F__)
constexpr int CHAINS = 16;
#else
constexpr int CHAINS = 12;
#endif
constexpr long STEPS = 100000;

// Evaluates independent chains of operations; their sum prevents the compiler from removing them.
template <class Step>
double chains(Step step) {
  Vector own[CHAINS];
  for (int k = 0; k < CHAINS; ++k) own[k] = all(1.0 + 1e-3 * k);
  for (long at = 0; at < STEPS; ++at) {
    for (int k = 0; k < CHAINS; ++k) own[k] = step(own[k]);
  }
  double sum = 0;
  for (int k = 0; k < CHAINS; ++k) {
    double lanes[LANES];
    std::memcpy(lanes, &own[k], sizeof lanes);
    for (double lane : lanes) sum += lane;
  }
  return sum;
}

int main(int count, char** words) {
  if (count != 3) {
    std::cerr << "usage: machine copy BYTES | fma 0 | divide 0 | root 0\n";
    return 2;
  }
  const std::string what = words[1];
  std::vector<char> from, to;
  size_t half = 0, times = 1;
  double amount = double(STEPS) * CHAINS * LANES;
  if (what == "copy") {
    half = std::stoull(words[2]) / 2;
    times = half < (1 << 24) ? (1 << 24) / half : 1;
    from.assign(half, 1);
    to.assign(half, 2);
    amount = 2.0 * half * times;
  }
  volatile double sink = 0, source = 0.999999;
  const Vector factor = all(source), small = all(1e-6);
  std::cout << "ready" << std::endl;
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words_of_line(line);
    std::string command, argument;
    words_of_line >> command >> argument;
    if (command == "write") {
      std::ofstream(argument) << amount << "\n";
    } else {
      for (int left = std::stoi(argument); left > 0; --left) {
        if (what == "fma") sink = sink + chains([&](Vector a) { return a * factor + small; });
        if (what == "divide") sink = sink + chains([&](Vector a) { return factor / a; });
        if (what == "root") sink = sink + chains([&](Vector a) { return root(a); });
        for (size_t at = 0; what == "copy" && at < times; ++at) {
          std::memcpy(to.data(), from.data(), half);
          // Prevents the compiler from removing repeated copies.
          asm volatile("" : : "r"(to.data()) : "memory");
        }
      }
    }
    std::cout << "done" << std::endl;
  }
}
