// Damaged copies of a glTF file, as accidents and attackers make them: cut short, with bytes overwritten, or with values of its JSON
// replaced by wild ones while everything else stays well-formed. One seed, one copy.
#pragma once
#include <cstdint>
#include <string>

namespace chiaro::test {

// SplitMix64 (Steele, Lea, Flood 2014).
class Dice {
public:
    explicit Dice(uint64_t seed) : state_(seed) {}
    uint64_t next() {
        uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ z >> 27) * 0x94d049bb133111ebull;
        return z ^ z >> 31;
    }
    std::size_t below(std::size_t n) { return n == 0 ? 0 : std::size_t(next() % n); }

private:
    uint64_t state_;
};

std::string mutated(const std::string& whole, uint64_t seed); // a .gltf or .glb
// The same with one value of the JSON replaced, removed, repeated or exchanged; the file itself where its JSON cannot be read.
std::string withWildValue(const std::string& whole, Dice&);

} // namespace chiaro::test
