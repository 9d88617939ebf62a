#include "src/narrow_phase/narrow_stream.hpp"

#include <algorithm>
#include <utility>

#include "src/device/stopwatch.hpp"
#include "src/narrow_phase/contact_list.hpp"

namespace clinch::detail {

std::vector<std::size_t> NarrowStream::begin(const Scene& scene) {
    narrow_.begin(scene);
    scene_ = &scene;
    unordered_.clear();
    keys_.clear();
    next_ = 0;
    pairs_on_host_ = 0;
    devices_ = narrow_.worth_a_device(few_pairs);
    return devices_ ? narrow_.devices.begin_stream() : std::vector<std::size_t>{};
}

void NarrowStream::find(std::size_t device, View<const Pair> pairs) {
    const auto [first, count] = narrow_.devices.find_streamed(device, {*scene_, pairs, false, nullptr}, next_, found());
    if (!sorted_) return;
    // While they are in the caches.
    keys_.write_at(first, count, 2 * (first + count), [&, row = first, rows = count](std::uint64_t* to) {
        unordered_.contacts.read_at(row, rows, [&](const Contact* from) {
            std::transform(from, from + rows, to, [](const Contact& c) { return ContactOrder::key(c); });
        });
    });
}

void NarrowStream::find_on_host(View<const Pair> pairs) {
    narrow_.find_on_host({*scene_, pairs, false, nullptr}, narrow_.result);
    pairs_on_host_ += pairs.size();
}

void NarrowStream::finish() {
    const Stopwatch watch;
    NarrowReport& report = narrow_.report;
    if (next_ > 0) found().contacts.resize(next_);
    if (sorted_) put_in_order();
    const bool margins = devices_ && narrow_.devices.finish_stream(report);
    report.pairs = pairs_on_host_;
    for (const DeviceShare& share : report.devices) report.pairs += share.pairs;
    if (margins) drop_beyond_margins(*scene_, narrow_.result.contacts);
    report.ms.gather += watch.ms();
    narrow_.finish_report(false);
}

void NarrowStream::put_in_order() {
    const auto bodies = static_cast<std::uint32_t>(scene_->row_count());
    if (next_ == 0) {  // the host's are where they belong, but for their order
        const View<const Contact> rows = narrow_.result.contacts.view();
        std::copy(rows.begin(), rows.end(), unordered_.contacts.grow(rows.size()));
        std::transform(rows.begin(), rows.end(), keys_.grow(rows.size()), ContactOrder::key);
        narrow_.result.clear();
    } else {
        keys_.resize(next_);
    }
    const View<const Contact> rows = unordered_.contacts.view();
    order_.put(rows, keys_.view(), bodies, narrow_.result.contacts.grow(rows.size()));
}

void NarrowStream::abandon() {
    narrow_.result.clear();
    narrow_.devices.forget();
}

}  // namespace clinch::detail
