// Random numbers of the reference path tracers.
#pragma once

#include <cstdint>

class Random {
public:
    explicit Random(std::uint64_t seed) : state(seed) {}
    // Uniform in [0, 1) (SplitMix64, Steele et al. 2014).
    double next() {
        std::uint64_t z = state += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return double((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }

private:
    std::uint64_t state;
};
