// What this core can do at most, as a worker: `machine copy BYTES`, `machine fma 0`, `machine divide 0`, `machine root 0`.
//
// Prints "ready", answers "run N" by doing N times as much, and "write FILE" by how much one time is: bytes read and
// written, or operations.
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
// More than the latency of an FMA times the units that do it.
constexpr int CHAINS = 16;
constexpr long STEPS = 100000;

// Chains that do not wait for each other; the sum keeps the compiler from leaving them out.
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
    std::cerr << "say: copy BYTES, fma 0, divide 0 or root 0\n";
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
  volatile double kept = 0, given = 0.999999;
  const Vector factor = all(given), small = all(1e-6);
  std::cout << "ready" << std::endl;
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream said(line);
    std::string ask, rest;
    said >> ask >> rest;
    if (ask == "write") {
      std::ofstream(rest) << amount << "\n";
    } else {
      for (int left = std::stoi(rest); left > 0; --left) {
        if (what == "fma") kept = kept + chains([&](Vector a) { return a * factor + small; });
        if (what == "divide") kept = kept + chains([&](Vector a) { return factor / a; });
        if (what == "root") kept = kept + chains([&](Vector a) { return root(a); });
        for (size_t at = 0; what == "copy" && at < times; ++at) {
          std::memcpy(to.data(), from.data(), half);
          // The compiler may not leave out a copy that is made again.
          asm volatile("" : : "r"(to.data()) : "memory");
        }
      }
    }
    std::cout << "done" << std::endl;
  }
}
