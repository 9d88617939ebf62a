#include "src/narrow_phase/contact_places.hpp"

namespace clinch::detail {

void ContactPlaces::tell(std::uint32_t chunk, std::size_t rows) {
    const std::lock_guard<std::mutex> lock(mutex_);
    rows_[chunk] = rows;
    told_ += rows;
    ++told_chunks_;
    for (; known_ < rows_.size() && rows_[known_] != unknown; ++known_) {
        firsts_[known_] = known_rows_;
        known_rows_ += rows_[known_];
    }
}

std::optional<std::size_t> ContactPlaces::first_of(std::uint32_t chunk) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (chunk < known_) return firsts_[chunk];
    return chunk == known_ ? std::optional<std::size_t>(known_rows_) : std::nullopt;
}

std::size_t ContactPlaces::told() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return told_;
}

std::size_t ContactPlaces::expected() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (told_chunks_ == 0) return 0;
    return static_cast<std::size_t>(static_cast<double>(told_) * static_cast<double>(rows_.size()) /
                                    static_cast<double>(told_chunks_)) +
           1;
}

}  // namespace clinch::detail
