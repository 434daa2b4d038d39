#include "tools/bench/symbols.h"
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <cxxabi.h>
#include <elf.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

namespace chiaro::bench {
namespace {

struct Region { // of memory, mapped from a file
    uintptr_t begin = 0, end = 0, offset = 0;
    std::string file;
};
struct Function {
    uintptr_t begin = 0, end = 0; // addresses of the file
    const char* name = nullptr;   // as the linker knows it
};

std::vector<Region> regions() {
    std::vector<Region> all;
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
        std::istringstream in(line);
        Region r;
        char dash = 0;
        std::string rights, device, inode;
        in >> std::hex >> r.begin >> dash >> r.end >> rights >> r.offset >> device >> inode >> r.file;
        if (rights.size() > 2 && rights[2] == 'x') all.push_back(r);
    }
    return all;
}

// The part of a file's bytes that is an array of T, empty where it does not lie inside.
template <class T> std::vector<T> tableAt(const std::vector<char>& bytes, std::size_t offset, std::size_t size) {
    if (offset > bytes.size() || size > bytes.size() - offset) return {};
    std::vector<T> all(size / sizeof(T));
    if (!all.empty()) std::memcpy(all.data(), bytes.data() + offset, all.size() * sizeof(T));
    return all;
}

// Up to the first parenthesis that is not inside template arguments.
std::string_view withoutParameters(std::string_view name) {
    int depth = 0;
    for (std::size_t i = 0; i < name.size(); ++i) {
        depth += name[i] == '<' ? 1 : name[i] == '>' ? -1 : 0;
        if (name[i] == '(' && depth <= 0) return name.substr(0, i);
    }
    return name;
}
// "void chiaro::(anonymous namespace)::TileLoop::run<4>(chiaro::Rect)" -> "chiaro::TileLoop::run<4>". A loop that was handed over by
// reference is called by the function that wrote it.
std::string plainName(const char* mangled) {
    int status = 0;
    char* const readable = abi::__cxa_demangle(mangled, nullptr, nullptr, &status);
    std::string name = status == 0 && readable ? readable : mangled;
    std::free(readable);
    constexpr std::string_view anonymous = "(anonymous namespace)::", handed = "::FunctionRef<";
    for (std::size_t at; (at = name.find(anonymous)) != std::string::npos;) name.erase(at, anonymous.size());
    if (const std::size_t at = name.find(handed, name.find(handed) + 1); at != std::string::npos) name.erase(0, at + handed.size());
    std::string_view plain = withoutParameters(name);
    if (const std::size_t space = plain.substr(0, plain.find('<')).rfind(' '); space != plain.npos) plain.remove_prefix(space + 1);
    return std::string(plain);
}

} // namespace

struct Symbols::Impl {
    std::vector<Region> maps = regions();
    std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    std::vector<char> bytes;
    std::vector<Elf64_Phdr> segments;
    std::vector<Function> functions;

    Impl() {
        std::ifstream in("/proc/self/exe", std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(in), {});
        const auto header = tableAt<Elf64_Ehdr>(bytes, 0, sizeof(Elf64_Ehdr));
        if (header.empty() || std::memcmp(header[0].e_ident, ELFMAG, SELFMAG) != 0 || header[0].e_ident[EI_CLASS] != ELFCLASS64) return;
        segments = tableAt<Elf64_Phdr>(bytes, header[0].e_phoff, header[0].e_phnum * sizeof(Elf64_Phdr));
        const auto sections = tableAt<Elf64_Shdr>(bytes, header[0].e_shoff, header[0].e_shnum * sizeof(Elf64_Shdr));
        for (const Elf64_Shdr& s : sections) {
            if (s.sh_type != SHT_SYMTAB || s.sh_link >= sections.size()) continue;
            const Elf64_Shdr& strings = sections[s.sh_link];
            if (strings.sh_offset > bytes.size() || strings.sh_size > bytes.size() - strings.sh_offset) continue;
            for (const Elf64_Sym& symbol : tableAt<Elf64_Sym>(bytes, s.sh_offset, s.sh_size))
                if (ELF64_ST_TYPE(symbol.st_info) == STT_FUNC && symbol.st_size > 0 && symbol.st_name < strings.sh_size)
                    functions.push_back({symbol.st_value, symbol.st_value + symbol.st_size, &bytes[strings.sh_offset + symbol.st_name]});
        }
        std::sort(functions.begin(), functions.end(), [](const Function& a, const Function& b) { return a.begin < b.begin; });
    }
    // From a place in the file to the address that the linker gave it.
    uintptr_t linked(uintptr_t offset) const {
        for (const Elf64_Phdr& s : segments)
            if (s.p_type == PT_LOAD && offset >= s.p_offset && offset < s.p_offset + s.p_filesz) return offset - s.p_offset + s.p_vaddr;
        return 0;
    }
};

Symbols::Symbols() : impl_(std::make_unique<Impl>()) {}
Symbols::~Symbols() = default;

Symbols::Place Symbols::at(uintptr_t address) const {
    for (const Region& r : impl_->maps) {
        if (address < r.begin || address >= r.end) continue;
        if (r.file != impl_->program) return {std::filesystem::path(r.file).filename().string(), true};
        const uintptr_t place = impl_->linked(address - r.begin + r.offset);
        const auto after = std::upper_bound(impl_->functions.begin(), impl_->functions.end(), place,
                                            [](uintptr_t a, const Function& f) { return a < f.begin; });
        if (after == impl_->functions.begin() || place >= std::prev(after)->end) return {"?", false};
        return {plainName(std::prev(after)->name), false};
    }
    return {"?", true};
}

} // namespace chiaro::bench
