#include "io/exr_header.h"
#include "io/image_read.h"
#include <cstring>
#include <fmt/format.h>

namespace chiaro {

namespace {

constexpr uint32_t manyParts = 0x1000; // flag beside the version

struct Header {
    int32_t data[4] = {0, 0, -1, -1}, display[4] = {0, 0, -1, -1}; // x0, y0, x1, y1, both ends in
    uint32_t tile[2] = {0, 0};
    size_t compression = 0;
    bool any = false;
};

class Reader {
public:
    Reader(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}
    uint32_t u32() {
        if (bytes_.size() - at_ < 4) cut();
        uint32_t v;
        std::memcpy(&v, &bytes_[at_], 4);
        at_ += 4;
        return v;
    }
    std::string_view text() {
        const size_t from = at_;
        while (at_ < bytes_.size() && bytes_[at_] != std::byte(0)) ++at_;
        if (at_ == bytes_.size()) cut();
        return {reinterpret_cast<const char*>(&bytes_[from]), at_++ - from};
    }
    std::span<const std::byte> block(uint32_t size) {
        if (size > bytes_.size() - at_) cut();
        at_ += size;
        return bytes_.subspan(at_ - size, size);
    }
    [[noreturn]] void cut() const { undecodable(name_, fmt::format("the OpenEXR header is cut short after {} bytes", bytes_.size())); }

private:
    std::span<const std::byte> bytes_;
    const std::string& name_;
    size_t at_ = 0;
};

// Up to the empty name that ends it.
Header readHeader(Reader& from) {
    Header h;
    for (std::string_view attribute = from.text(); !attribute.empty(); attribute = from.text()) {
        h.any = true;
        from.text(); // its type
        const auto value = from.block(from.u32());
        const auto copy = [&](void* to, size_t size) {
            if (value.size() >= size) std::memcpy(to, value.data(), size);
        };
        if (attribute == "dataWindow") copy(h.data, sizeof h.data);
        if (attribute == "displayWindow") copy(h.display, sizeof h.display);
        if (attribute == "tiles") copy(h.tile, sizeof h.tile);
        if (attribute == "compression") copy(&h.compression, 1);
    }
    return h;
}

void check(const Header& h, size_t length, const std::string& name) {
    constexpr uint64_t maxPixels = uint64_t(1) << 28, linesOf[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
    const auto size = [](const int32_t(&box)[4], int axis) { return int64_t(box[axis + 2]) - box[axis] + 1; };
    for (const auto* box : {&h.data, &h.display}) {
        const int64_t width = size(*box, 0), height = size(*box, 1);
        if (width <= 0 || height <= 0 || uint64_t(width) * uint64_t(height) > maxPixels)
            undecodable(name, fmt::format("{} x {} pixels; the limit is {}", width, height, maxPixels));
    }
    const auto over = [](uint64_t whole, uint64_t part) { return (whole + part - 1) / part; };
    const uint64_t width = uint64_t(size(h.data, 0)), height = uint64_t(size(h.data, 1));
    const uint64_t blocks = h.tile[0] && h.tile[1] ? over(width, h.tile[0]) * over(height, h.tile[1])
                                                   : over(height, linesOf[std::min(h.compression, std::size(linesOf) - 1)]);
    if (blocks > length / 8) // each has its place in a table of 8 bytes an entry
        undecodable(name, fmt::format("{} x {} pixels, more than its {} bytes can hold", width, height, length));
}

} // namespace

void checkExrHeader(std::span<const std::byte> bytes, const std::string& name) {
    Reader from(bytes, name);
    from.u32(); // the mark
    const bool several = from.u32() & manyParts;
    do {
        const Header h = readHeader(from);
        if (!h.any && several) return; // the empty header that ends the list
        check(h, bytes.size(), name);
    } while (several);
}

} // namespace chiaro
