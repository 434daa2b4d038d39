// Symbols: which function of this program, or which library, an address lies in. Read from the program's own file (ELF, .symtab) and from
// /proc/self/maps; of a program without symbols only the libraries are known.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

namespace chiaro::bench {

class Symbols {
public:
    Symbols();
    ~Symbols();
    struct Place {
        std::string name; // of the function without its parameters; of a library the file
        bool library = false;
    };
    Place at(uintptr_t address) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace chiaro::bench
