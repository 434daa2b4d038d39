// Profile: where the threads of this process are, asked by the clock of the processor a few hundred times a second (SIGPROF, setitimer):
// the program under measure is not changed, and pays for the asking alone. An answer is an address; a symbol table says which function it
// lies in, and the function's name which part of a renderer that is. What the compiler has put inline counts for the function that it was
// put into. One profile at a time in the process.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace chiaro::bench {

enum class Part { trace, packets, lights, shading, textures, sampler, film, walk, other, waiting };
inline constexpr int partCount = 10;
std::string_view partName(Part) noexcept;
// Of a function of this program, by its name without parameters: "chiaro::Film::add".
Part partOf(std::string_view function) noexcept;

struct TimeSplit {
    std::array<double, partCount> share{};   // of the time that the processors worked for us, together 1
    std::map<std::string, double> functions; // the same, by function or library
    double idle = 0;                         // of all threads' time: they had no work, or somebody else had the processor
    uint64_t samples = 0;
};

class Profile {
public:
    Profile();
    ~Profile();
    void start(); // asks from here on
    void stop();
    // threads: that could have worked in all that time.
    TimeSplit split(unsigned threads) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace chiaro::bench
