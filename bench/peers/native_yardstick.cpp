// What these cores give without portability: two plain programs written for AVX-512 and OpenMP. They show how much
// clinch pays for being OpenCL; they are tuned for scenes, not for every input.
//   grid   cells as wide as the widest box, counting sort by the min corner, half neighbourhood, vectors
//          inside; a few boxes much larger than the others are tested against all cells that they reach
//   sweep  sort on the axis of greatest variance, forward sweep in vectors
#include <immintrin.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "bench/peers/peer.hpp"

namespace clinch::peers {
namespace {

constexpr std::size_t width = 16;  // floats of a vector
constexpr float infinity = std::numeric_limits<float>::infinity();

/// Boxes as columns: min x, y, z, max x, y, z and their numbers; after the last come boxes that overlap none.
struct Columns {
    std::array<std::vector<float>, 6> c;
    std::vector<std::uint32_t> number;

    void resize(std::size_t n) {
        for (std::size_t d = 0; d < 6; ++d) {
            c[d].resize(n + width);
            std::fill(c[d].end() - width, c[d].end(), d < 3 ? infinity : -infinity);
        }
        number.resize(n + width);
    }
    void set(std::size_t at, const Aabb& box, std::uint32_t i) {
        for (std::size_t d = 0; d < 3; ++d) c[d][at] = box.min[d], c[d + 3][at] = box.max[d];
        number[at] = i;
    }
};

/// One box in every lane.
struct Query {
    __m512 c[6];
    __m512i number;
    Query(const Aabb& box, std::uint32_t i) : number(_mm512_set1_epi32(static_cast<int>(i))) {
        for (int d = 0; d < 3; ++d) c[d] = _mm512_set1_ps(box.min[d]), c[d + 3] = _mm512_set1_ps(box.max[d]);
    }
    Query(const Columns& columns, std::size_t at) : number(_mm512_set1_epi32(static_cast<int>(columns.number[at]))) {
        for (std::size_t d = 0; d < 6; ++d) c[d] = _mm512_set1_ps(columns.c[d][at]);
    }
};

/// A thread's pairs: memory that stays, written 16 at a time.
class alignas(128) Out {
public:
    void clear() { used_ = 0; }
    View<const Pair> view() const { return {pairs_.data(), used_}; }

    /// Adds the pairs of the query with the boxes j of `mask`.
    void add(__mmask16 mask, const Query& query, const Columns& columns, std::size_t j) {
        if (pairs_.size() < used_ + width) pairs_.resize(std::max<std::size_t>(2 * pairs_.size(), 4096));
        const __m512i others = _mm512_maskz_compress_epi32(mask, _mm512_loadu_si512(columns.number.data() + j));
        const __m512i a = _mm512_min_epu32(others, query.number), b = _mm512_max_epu32(others, query.number);
        const auto count = static_cast<unsigned>(__builtin_popcount(mask));
        store(0, _mm512_castsi512_si256(a), _mm512_castsi512_si256(b));
        if (count > 8) store(8, _mm512_extracti64x4_epi64(a, 1), _mm512_extracti64x4_epi64(b, 1));
        used_ += count;
    }

private:
    void store(std::size_t at, __m256i a, __m256i b) {
        const __m512i high = _mm512_slli_epi64(_mm512_cvtepu32_epi64(b), 32);
        _mm512_storeu_si512(pairs_.data() + used_ + at, _mm512_or_si512(_mm512_cvtepu32_epi64(a), high));
    }

    std::vector<Pair> pairs_;
    std::size_t used_ = 0;
};

/// Which of boxes j .. j + 15 overlap the query, of those in `mask`.
__mmask16 hits(__mmask16 mask, const Query& q, const Columns& p, std::size_t j) {
    for (std::size_t d = 0; d < 3; ++d) {
        mask = _mm512_mask_cmp_ps_mask(mask, _mm512_loadu_ps(p.c[d].data() + j), q.c[d + 3], _CMP_LE_OQ);
        mask = _mm512_mask_cmp_ps_mask(mask, _mm512_loadu_ps(p.c[d + 3].data() + j), q.c[d], _CMP_GE_OQ);
    }
    return mask;
}

/// The query against boxes begin .. end - 1.
void test_run(const Query& query, const Columns& columns, std::size_t begin, std::size_t end, Out& out) {
    for (std::size_t j = begin; j < end; j += width) {
        const auto lanes = static_cast<__mmask16>(end - j >= width ? 0xffffu : (1u << (end - j)) - 1u);
        const __mmask16 mask = hits(lanes, query, columns, j);
        if (mask != 0) out.add(mask, query, columns, j);
    }
}

Lists views_of(const std::vector<Out>& outs) {
    Lists lists;
    for (const Out& out : outs) lists.push_back(out.view());
    return lists;
}

std::size_t this_thread() {
    return static_cast<std::size_t>(omp_get_thread_num());
}

double widest_side(const Aabb& box) {
    double widest = 0.0;
    for (int d = 0; d < 3; ++d) widest = std::max(widest, double{box.max[d]} - double{box.min[d]});
    return widest;
}

class Sweep : public Peer {
public:
    explicit Sweep(unsigned threads) : outs_(threads) {}

    Lists run(View<const Aabb> boxes) override {
        const std::size_t n = boxes.size();
        sort(boxes);
        for (Out& out : outs_) out.clear();
#pragma omp parallel num_threads(static_cast <int>(outs_.size())) if (n > 2000)
        {
            Out& out = outs_[this_thread()];
#pragma omp for schedule(dynamic, 256)
            for (std::size_t i = 0; i < n; ++i) sweep_from(i, out);
        }
        return views_of(outs_);
    }

private:
    // Forward until a box begins behind the end of box i; those after the last do.
    void sweep_from(std::size_t i, Out& out) const {
        const Query query(sorted_, i);
        const float* const begins = sorted_.c[axis_].data();
        for (std::size_t j = i + 1;; j += width) {
            const __mmask16 near = _mm512_cmp_ps_mask(_mm512_loadu_ps(begins + j), query.c[axis_ + 3], _CMP_LE_OQ);
            const __mmask16 mask = hits(near, query, sorted_, j);
            if (mask != 0) out.add(mask, query, sorted_, j);
            if (near != 0xffff) return;
        }
    }

    void sort(View<const Aabb> boxes) {
        axis_ = widest_axis(boxes);
        keys_.resize(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const float begin = boxes[i].min[axis_] + 0.0f;  // one zero
            std::uint32_t bits = 0;
            std::memcpy(&bits, &begin, sizeof bits);
            bits ^= (bits >> 31) != 0 ? 0xffffffffu : 0x80000000u;
            keys_[i] = std::uint64_t{bits} << 32 | i;
        }
        std::sort(keys_.begin(), keys_.end());
        sorted_.resize(boxes.size());
        for (std::size_t at = 0; at < boxes.size(); ++at) {
            const auto i = static_cast<std::uint32_t>(keys_[at]);
            sorted_.set(at, boxes[i], i);
        }
    }

    static std::size_t widest_axis(View<const Aabb> boxes) {
        std::array<double, 3> variance{};
        for (std::size_t d = 0; d < 3; ++d) {
            double sum = 0.0, square = 0.0;
            for (const Aabb& box : boxes) sum += double{box.min[d]}, square += double{box.min[d]} * double{box.min[d]};
            variance[d] = square - sum * sum / static_cast<double>(std::max<std::size_t>(boxes.size(), 1));
        }
        return static_cast<std::size_t>(std::max_element(variance.begin(), variance.end()) - variance.begin());
    }

    std::size_t axis_ = 0;
    std::vector<std::uint64_t> keys_;
    Columns sorted_;
    std::vector<Out> outs_;
};

class Grid : public Peer {
public:
    explicit Grid(unsigned threads) : threads_(threads), counts_(threads), outs_(threads) {}

    Lists run(View<const Aabb> boxes) override {
        for (Out& out : outs_) out.clear();
        lay_out(boxes);
        sort(boxes);
        test_small();
        if (!large_.empty()) test_large(boxes);
        return views_of(outs_);
    }

private:
    /// Chooses the cells. Boxes whose min corners are at most a cell apart lie in neighbouring cells; up to one box in
    /// 500 may be larger than a cell.
    void lay_out(View<const Aabb> boxes) {
        std::array<float, 3> low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
        double widest = 0.0;
        for (const Aabb& box : boxes) {
            for (std::size_t d = 0; d < 3; ++d) {
                low[d] = std::min(low[d], box.min[d]);
                high[d] = std::max(high[d], box.min[d]);
            }
            widest = std::max(widest, widest_side(box));
        }
        const double usual = usual_side(boxes);
        limit_ = widest <= 2.0 * usual ? widest : usual;
        double cell = std::max(limit_ * 1.000001, 1e-30), cells = 1.0;
        for (std::size_t d = 0; d < 3; ++d) cells *= std::max((double{high[d]} - double{low[d]}) / cell, 1.0);
        cell *= std::cbrt(std::max(cells / (8.0 * static_cast<double>(boxes.size()) + 1000.0), 1.0));
        for (std::size_t d = 0; d < 3; ++d) {
            const double extent = double{high[d]} - double{low[d]};
            low_[d] = low[d];
            cells_[d] = static_cast<std::size_t>(std::max(extent / cell, 1.0));
            scale_[d] = extent > 0.0 ? static_cast<double>(cells_[d]) / extent : 0.0;
        }
        row_ = cells_[0] + 2;
        layer_ = row_ * (cells_[1] + 2);
    }

    /// The side that only one box in 500 exceeds, by a sample.
    double usual_side(View<const Aabb> boxes) {
        sample_.clear();
        const std::size_t stride = boxes.size() / 4096 + 1;
        for (std::size_t i = stride / 2; i < boxes.size(); i += stride) sample_.push_back(widest_side(boxes[i]));
        if (sample_.empty()) return 0.0;
        const auto at = sample_.begin() + static_cast<std::ptrdiff_t>(sample_.size() - 1 - sample_.size() / 500);
        std::nth_element(sample_.begin(), at, sample_.end());
        return *at;
    }

    /// 1 .. cells: the outermost ones go on for ever.
    std::size_t cell_along(std::size_t d, double x) const {
        const double c = std::max((x - low_[d]) * scale_[d], 0.0);
        return std::min(static_cast<std::size_t>(c), cells_[d] - 1) + 1;
    }

    std::uint32_t cell_of(const Aabb& box) const {
        const std::size_t x = cell_along(0, double{box.min[0]}), y = cell_along(1, double{box.min[1]});
        return static_cast<std::uint32_t>(cell_along(2, double{box.min[2]}) * layer_ + y * row_ + x);
    }

    /// A counting sort, a histogram a thread. Large boxes go into the cell after all others.
    void sort(View<const Aabb> boxes) {
        const std::size_t n = boxes.size(), cells = layer_ * (cells_[2] + 2);
        const auto last = static_cast<std::uint32_t>(cells);
        cell_.resize(n);
        start_.resize(cells + 2);
        sorted_.resize(n);
        const auto first_of = [&](std::size_t thread) { return n * thread / threads_; };
#pragma omp parallel num_threads(static_cast <int>(threads_)) if (n > 2000)
        for (std::size_t t = this_thread(); t < threads_; t += static_cast<std::size_t>(omp_get_num_threads())) {
            std::vector<std::uint32_t>& count = counts_[t];
            count.assign(cells + 1, 0);
            for (std::size_t i = first_of(t); i < first_of(t + 1); ++i)
                ++count[cell_[i] = widest_side(boxes[i]) <= limit_ ? cell_of(boxes[i]) : last];
        }
        std::uint32_t at = 0;
        for (std::size_t c = 0; c <= cells; ++c) {
            start_[c] = at;
            for (std::vector<std::uint32_t>& count : counts_) {
                const std::uint32_t boxes_here = count[c];
                count[c] = at;
                at += boxes_here;
            }
        }
        start_[cells + 1] = at;
#pragma omp parallel num_threads(static_cast <int>(threads_)) if (n > 2000)
        for (std::size_t t = this_thread(); t < threads_; t += static_cast<std::size_t>(omp_get_num_threads()))
            for (std::size_t i = first_of(t); i < first_of(t + 1); ++i)
                sorted_.set(counts_[t][cell_[i]]++, boxes[i], static_cast<std::uint32_t>(i));
        large_.assign(sorted_.number.begin() + start_[last], sorted_.number.begin() + at);
    }

    /// Each box against those after it in its row of three cells, and in the four rows ahead.
    void test_small() {
        const std::size_t rows = cells_[1] * cells_[2];
#pragma omp parallel num_threads(static_cast <int>(threads_)) if (sorted_.number.size() > 2000)
        {
            Out& out = outs_[this_thread()];
#pragma omp for schedule(dynamic, 4)
            for (std::size_t r = 0; r < rows; ++r) {
                const std::size_t first = (r / cells_[1] + 1) * layer_ + (r % cells_[1] + 1) * row_ + 1;
                for (std::size_t c = first; c < first + cells_[0]; ++c) test_cell(c, out);
            }
        }
    }

    void test_cell(std::size_t c, Out& out) const {
        const std::array<std::size_t, 4> ahead{c + row_ - 1, c + layer_ - row_ - 1, c + layer_ - 1,
                                               c + layer_ + row_ - 1};
        for (std::size_t i = start_[c]; i < start_[c + 1]; ++i) {
            const Query query(sorted_, i);
            test_run(query, sorted_, i + 1, start_[c + 2], out);
            for (const std::size_t row : ahead) test_run(query, sorted_, start_[row], start_[row + 3], out);
        }
    }

    /// Each large box against the small ones in the rows of cells that it reaches, and the large ones after it.
    void test_large(View<const Aabb> boxes) {
        const std::size_t small = sorted_.number.size() - width - large_.size();
#pragma omp parallel num_threads(static_cast <int>(threads_))
        {
            Out& out = outs_[this_thread()];
#pragma omp for schedule(dynamic, 4)
            for (std::size_t k = 0; k < large_.size(); ++k) {
                const Aabb& box = boxes[large_[k]];
                const Query query(box, large_[k]);
                test_reach(query, box, out);
                test_run(query, sorted_, small + k + 1, small + large_.size(), out);
            }
        }
    }

    void test_reach(const Query& query, const Aabb& box, Out& out) const {
        std::array<std::size_t, 3> first{}, last{};
        for (std::size_t d = 0; d < 3; ++d) {
            first[d] = cell_along(d, double{box.min[d]} - 1.000001 * limit_);
            last[d] = cell_along(d, double{box.max[d]});
        }
        for (std::size_t z = first[2]; z <= last[2]; ++z)
            for (std::size_t y = first[1]; y <= last[1]; ++y) {
                const std::size_t row = z * layer_ + y * row_;
                test_run(query, sorted_, start_[row + first[0]], start_[row + last[0] + 1], out);
            }
    }

    std::size_t threads_, row_ = 0, layer_ = 0;
    std::array<double, 3> low_{}, scale_{};
    std::array<std::size_t, 3> cells_{};
    double limit_ = 0.0;  // boxes with a longer side are large
    std::vector<double> sample_;
    std::vector<std::uint32_t> cell_, start_, large_;
    std::vector<std::vector<std::uint32_t>> counts_;
    Columns sorted_;
    std::vector<Out> outs_;
};

}  // namespace

std::unique_ptr<Peer> make_native_grid(const Setup& setup) {
    return std::make_unique<Grid>(setup.threads);
}
std::unique_ptr<Peer> make_native_sweep(const Setup& setup) {
    return std::make_unique<Sweep>(setup.threads);
}

}  // namespace clinch::peers
