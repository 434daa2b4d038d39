// Archive: how state that cannot be recomputed goes to a file and comes back: solved pre-passes, the memory of progressive integrators.
// Plain values and arrays of them in the machine's own byte order, one after the other, each array led by its length. Whoever owns the file
// puts before it what it belongs to (scene, options, seed, format) and checks that first; a Reader checks lengths, so that a damaged file
// ends in one clear error and never in a wrong picture.
#pragma once
#include "core/render/error.h"
#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace chiaro {

template <class T>
concept Plain = std::is_trivially_copyable_v<T>;

class Writer {
public:
    explicit Writer(std::ostream& to) : to_(to) {}
    template <Plain T> void value(const T& v) { bytes(&v, sizeof v); }
    template <Plain T> void array(std::span<const T> v) {
        value(uint64_t(v.size()));
        bytes(v.data(), v.size_bytes());
    }
    template <Plain T> void array(const std::vector<T>& v) { array(std::span<const T>(v)); }
    void text(std::string_view);

private:
    void bytes(const void*, std::size_t);
    std::ostream& to_;
};

// Throws Error(Exit::file, "NAME: ...") where the file ends too early or names a length that cannot be.
class Reader {
public:
    // name: of the file, for errors. bytesLeft: how much there can still be.
    Reader(std::istream& from, std::string name, uint64_t bytesLeft) : from_(from), name_(std::move(name)), left_(bytesLeft) {}
    template <Plain T> T value() {
        T v{};
        bytes(&v, sizeof v);
        return v;
    }
    template <Plain T> std::vector<T> array() {
        const auto n = value<uint64_t>();
        if (n > left_ / sizeof(T)) tooShort();
        std::vector<T> v(n);
        bytes(v.data(), n * sizeof(T));
        return v;
    }
    std::string text();
    [[noreturn]] void refuse(std::string_view why) const; // "NAME: why"
    uint64_t left() const noexcept { return left_; }

private:
    void bytes(void*, std::size_t);
    [[noreturn]] void tooShort() const;
    std::istream& from_;
    std::string name_;
    uint64_t left_;
};

} // namespace chiaro
