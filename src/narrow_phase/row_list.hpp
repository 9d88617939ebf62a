// Rows of a result on the host, filled chunk by chunk.
#pragma once

#include <algorithm>
#include <boost/container/vector.hpp>
#include <cstddef>
#include <mutex>
#include <shared_mutex>
#include <type_traits>

#include "clinch/view.hpp"

namespace clinch::detail {

/// Grows by chunks; keeps its memory from call to call. What is not written is undefined.
template <class Row>
class RowList {
    static_assert(std::is_trivially_copyable_v<Row> && std::is_trivially_destructible_v<Row>, "rows are bytes");

public:
    void clear() noexcept { size_ = 0; }
    std::size_t size() const noexcept { return size_; }
    View<const Row> view() const noexcept { return {rows(), size_}; }
    /// Appends room for `by` rows, which the caller writes. Valid until the next call.
    Row* grow(std::size_t by) {
        const std::size_t before = size_;
        size_ += by;
        if (memory_.size() < size_) {
            const std::size_t room = std::max(size_, memory_.size() + memory_.size() / 2);
            if (before == 0) memory_.clear();  // nothing is to be copied
            allocate(room);
        }
        return rows() + before;
    }
    /// Calls write(to) with the place of `count` rows from number `first` on; so may several threads at once, for rows
    /// of their own. What is beyond size() is kept until resize() has it. Where there is no room it is made for about
    /// `expected` rows.
    template <class Write>
    void write_at(std::size_t first, std::size_t count, std::size_t expected, const Write& write) {
        make_room(first + count, expected);
        const std::shared_lock<std::shared_mutex> lock(growing_);
        write(rows() + first);
    }
    /// Calls read(from) with the place of `count` rows from number `first` on, which write_at() has written, while
    /// others write theirs.
    template <class Read>
    void read_at(std::size_t first, std::size_t count, const Read& read) {
        if (count == 0) return;
        const std::shared_lock<std::shared_mutex> lock(growing_);
        read(rows() + first);
    }
    /// From now on there are so many rows.
    void resize(std::size_t size) {
        if (memory_.size() < size) allocate(size);
        size_ = size;
    }
    /// Takes out the rows of which `out` holds; the others keep their order.
    template <class Out>
    void drop_if(const Out& out) {
        Row* const begin = rows();
        size_ = static_cast<std::size_t>(std::remove_if(begin, begin + size_, out) - begin);
    }

private:
    // Not much more than is sure to be needed: what is expected may be wrong.
    void make_room(std::size_t needed, std::size_t expected) {
        {
            const std::shared_lock<std::shared_mutex> lock(growing_);
            if (memory_.size() >= needed) return;
        }
        const std::lock_guard<std::shared_mutex> lock(growing_);
        if (memory_.size() < needed) allocate(std::max(needed, std::min(expected + expected / 16, 4 * needed)));
    }

    void allocate(std::size_t rows) { memory_.resize(rows, boost::container::default_init); }
    Row* rows() noexcept { return reinterpret_cast<Row*>(memory_.data()); }
    const Row* rows() const noexcept { return reinterpret_cast<const Row*>(memory_.data()); }

    // Of a row; not filled before the row is written, as that would touch fresh memory twice.
    struct Bytes {
        alignas(Row) unsigned char bytes[sizeof(Row)];
    };
    std::shared_mutex growing_;               // held by one that moves the rows, shared by those that write them
    boost::container::vector<Bytes> memory_;  // as long as the longest list was: what is behind size_ is old
    std::size_t size_ = 0;
};

}  // namespace clinch::detail
