// FixedVector: up to N values on the stack, made when they are added: no heap, and nothing written for those that never come. For the
// batches of rays that integrators gather at a vertex.
#pragma once
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace chiaro {

template <class T, std::size_t N> class FixedVector {
    static_assert(std::is_trivially_destructible_v<T>);

public:
    FixedVector() noexcept {} // leaves the bytes as they are
    FixedVector(const FixedVector&) = delete;
    FixedVector& operator=(const FixedVector&) = delete;
    // There must be room.
    template <class... A> T& add(A&&... a) noexcept { return *::new (data() + size_++) T{std::forward<A>(a)...}; }
    void drop() noexcept { --size_; } // the last one
    void clear() noexcept { size_ = 0; }
    bool full() const noexcept { return size_ == N; }
    std::size_t size() const noexcept { return size_; }
    T* data() noexcept { return reinterpret_cast<T*>(bytes_); }
    T& operator[](std::size_t i) noexcept { return data()[i]; }
    T* begin() noexcept { return data(); }
    T* end() noexcept { return data() + size_; }

private:
    alignas(T) std::byte bytes_[N * sizeof(T)];
    std::size_t size_ = 0;
};

} // namespace chiaro
