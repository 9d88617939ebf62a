#include "src/narrow_phase/narrow_stream.hpp"

#include "src/device/stopwatch.hpp"
#include "src/narrow_phase/contact_list.hpp"

namespace clinch::detail {

std::vector<std::size_t> NarrowStream::begin(const Scene& scene) {
    narrow_.begin(scene);
    scene_ = &scene;
    on_host_.clear();
    pairs_on_host_ = 0;
    std::vector<std::size_t> devices;
    devices_ = narrow_.worth_a_device(few_pairs);
    if (devices_) devices = narrow_.devices.begin_stream();
    for (auto& [device, found] : found_) found->clear();
    // Threads only look them up.
    for (const std::size_t device : devices)
        if (std::unique_ptr<NarrowResult>& found = found_[device]; !found) found = std::make_unique<NarrowResult>();
    return devices;
}

void NarrowStream::find(std::size_t device, View<const Pair> pairs) {
    narrow_.devices.find_streamed(device, {*scene_, pairs, false, nullptr}, *found_.at(device));
}

void NarrowStream::find_on_host(View<const Pair> pairs) {
    narrow_.find_on_host({*scene_, pairs, false, nullptr}, on_host_);
    pairs_on_host_ += pairs.size();
}

void NarrowStream::finish() {
    const Stopwatch watch;
    NarrowReport& report = narrow_.report;
    std::vector<View<const Contact>> lists{on_host_.contacts.view()};
    std::size_t rows = on_host_.contacts.size();
    for (const auto& [device, found] : found_) {
        lists.push_back(found->contacts.view());
        rows += found->contacts.size();
    }
    order_.put(lists, static_cast<std::uint32_t>(scene_->row_count()), narrow_.result.contacts.grow(rows));
    const bool margins = devices_ && narrow_.devices.finish_stream(report);
    report.pairs = pairs_on_host_;
    for (const DeviceShare& share : report.devices) report.pairs += share.pairs;
    if (margins) drop_beyond_margins(*scene_, narrow_.result.contacts);
    report.ms.gather += watch.ms();
    narrow_.finish_report(false);
}

void NarrowStream::abandon() {
    narrow_.result.clear();
    narrow_.devices.forget();
}

}  // namespace clinch::detail
