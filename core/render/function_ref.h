// A callable by reference: two words, no heap. Valid as long as what it was made from.
#pragma once
#include <memory>
#include <type_traits>
#include <utility>

namespace chiaro {

template <class> class FunctionRef;
template <class R, class... A> class FunctionRef<R(A...)> {
public:
    template <class F>
        requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef>)
    FunctionRef(F&& f) noexcept // NOLINT: meant to be implicit
        : self_(const_cast<void*>(static_cast<const void*>(std::addressof(f)))),
          call_([](void* s, A... a) -> R { return (*static_cast<std::remove_reference_t<F>*>(s))(std::forward<A>(a)...); }) {}
    R operator()(A... a) const { return call_(self_, std::forward<A>(a)...); }

private:
    void* self_;
    R (*call_)(void*, A...);
};

} // namespace chiaro
