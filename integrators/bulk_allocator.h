// BulkAllocator: for arrays of hundreds of megabytes that are written once from end to end. Large pages where the system gives them, since
// a fault for every four kilobytes costs more than what is written there; and elements are left as they come until somebody writes them, so
// that threads take their own parts.
#pragma once
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <sys/mman.h>
#include <type_traits>

namespace chiaro {

template <class T> struct BulkAllocator {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    using value_type = T;
    static constexpr std::size_t page = std::size_t(1) << 21;
    BulkAllocator() = default;
    template <class U> BulkAllocator(const BulkAllocator<U>&) noexcept {}
    T* allocate(std::size_t n) {
        const std::size_t bytes = n * sizeof(T);
        if (bytes < page) return std::allocator<T>().allocate(n);
        const std::size_t whole = (bytes + page - 1) / page * page;
        void* const memory = std::aligned_alloc(page, whole);
        if (!memory) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        madvise(memory, whole, MADV_HUGEPAGE); // a wish: where it fails, pages are small
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t n) noexcept {
        if (n * sizeof(T) < page)
            std::allocator<T>().deallocate(memory, n);
        else
            std::free(memory);
    }
    template <class U> void construct(U*) noexcept {} // whatever is there
    template <class U, class... A> void construct(U* at, A&&... a) { std::construct_at(at, std::forward<A>(a)...); }
    friend bool operator==(const BulkAllocator&, const BulkAllocator&) noexcept { return true; }
};

} // namespace chiaro
