// Rows of a result on the host, filled chunk by chunk.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "clinch/view.hpp"

namespace clinch::detail {

/// Grows by chunks; keeps its memory from call to call.
template <class Row>
class RowList {
public:
    void clear() noexcept { size_ = 0; }
    std::size_t size() const noexcept { return size_; }
    View<const Row> view() const noexcept { return {rows_.data(), size_}; }
    /// Appends room for `by` rows, which the caller writes. Valid until the next call.
    Row* grow(std::size_t by) {
        const std::size_t before = size_;
        size_ += by;
        if (rows_.size() < size_) rows_.resize(std::max(size_, rows_.size() + rows_.size() / 2));
        return rows_.data() + before;
    }
    /// Takes out the rows of which `out` holds; the others keep their order.
    template <class Out>
    void drop_if(const Out& out) {
        Row* const begin = rows_.data();
        size_ = static_cast<std::size_t>(std::remove_if(begin, begin + size_, out) - begin);
    }

private:
    std::vector<Row> rows_;      // as long as the longest list was: what is behind size_ is old
    std::size_t size_ = 0;
};

}  // namespace clinch::detail
