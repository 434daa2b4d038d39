#include "core/render/archive.h"
#include <fmt/format.h>
#include <istream>
#include <ostream>

namespace chiaro {

void Writer::bytes(const void* data, std::size_t size) { to_.write(static_cast<const char*>(data), std::streamsize(size)); }

void Writer::text(std::string_view s) { array(std::span<const char>(s)); }

void Reader::bytes(void* data, std::size_t size) {
    if (size > left_ || !from_.read(static_cast<char*>(data), std::streamsize(size))) tooShort();
    left_ -= size;
}

std::string Reader::text() {
    const std::vector<char> v = array<char>();
    return {v.begin(), v.end()};
}

void Reader::tooShort() const { refuse("the file is cut short or damaged; make it again"); }

void Reader::refuse(std::string_view why) const { throw Error(Exit::file, fmt::format("{}: {}", name_, why)); }

} // namespace chiaro
