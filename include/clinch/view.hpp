// A pointer and a length: how arrays are passed in and handed out.
#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

namespace clinch {

/// A non-owning view of `size()` consecutive elements (std::span is C++20). Valid as long as the
/// memory it was made from; copying it copies no element.
template <class T>
class View {
public:
    constexpr View() noexcept = default;
    constexpr View(T* data, std::size_t size) noexcept : data_(data), size_(size) {}
    /// A view of a whole vector; the vector must outlive it and must not grow meanwhile.
    View(const std::vector<std::remove_const_t<T>>& v) noexcept : data_(v.data()), size_(v.size()) {}  // NOLINT

    constexpr T* data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T* begin() const noexcept { return data_; }
    constexpr T* end() const noexcept { return data_ + size_; }
    /// Element i; i < size() is not checked.
    constexpr T& operator[](std::size_t i) const noexcept { return data_[i]; }

private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace clinch
