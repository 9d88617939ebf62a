// A bounded buffer between the phases: what the broad phase finds streams to the narrow phase chunk by chunk
// [thesis 6.1].
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

#include "clinch/error.hpp"

namespace clinch::detail {

/// First in, first out, any number of producers and consumers. Every producer holds a Producer and every consumer a
/// Consumer while it works: whoever leaves by an exception then wakes all others, and nobody waits for it for ever. A
/// consumer that has enough before take() says nullopt must cancel().
template <class T>
class ChunkBuffer {
public:
    /// Holds `most` items at a time, 1 or more (else throws Error, InvalidArgument). `producers`: how many will call
    /// producer_done(); a consumer that comes before the first of them waits.
    explicit ChunkBuffer(std::size_t most, std::size_t producers = 0) : most_(most), producers_(producers) {
        if (most == 0) throw Error(ErrorCode::InvalidArgument, "a chunk buffer of no items: must hold at least 1");
    }
    ChunkBuffer(const ChunkBuffer&) = delete;
    ChunkBuffer& operator=(const ChunkBuffer&) = delete;
    ~ChunkBuffer() = default;

    /// One more than said at construction.
    void add_producer() {
        const std::lock_guard<std::mutex> lock(mutex_);
        ++producers_;
    }
    /// One producer will put no more. Once a producer.
    void producer_done() {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (producers_ > 0) --producers_;
        if (producers_ == 0) filled_.notify_all();
    }

    /// Waits while the buffer is full. False, without the item, once cancelled: it is of no use to go on.
    bool put(T item) {
        std::unique_lock<std::mutex> lock(mutex_);
        emptied_.wait(lock, [this] { return cancelled_ || items_.size() < most_; });
        if (cancelled_) return false;
        items_.push_back(std::move(item));
        most_held_ = std::max(most_held_, items_.size());
        filled_.notify_one();
        return true;
    }

    /// As put(), but does not wait: false, and the item stays, while the buffer is full. Once cancelled the item is
    /// dropped, as put() does; cancelled() tells.
    bool try_put(T& item) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!cancelled_) {
            if (items_.size() >= most_) return false;
            items_.push_back(std::move(item));
            most_held_ = std::max(most_held_, items_.size());
            filled_.notify_one();
        }
        return true;
    }

    /// As take(), but does not wait: nullopt also while the buffer is empty.
    std::optional<T> try_take() {
        const std::lock_guard<std::mutex> lock(mutex_);
        return take_first();
    }

    /// Waits while the buffer is empty and a producer is not done. nullopt: all was taken, or cancelled().
    std::optional<T> take() {
        std::unique_lock<std::mutex> lock(mutex_);
        filled_.wait(lock, [this] { return cancelled_ || producers_ == 0 || !items_.empty(); });
        return take_first();
    }

    /// By either side: drops what is held and wakes everybody; put() and take() do nothing from now on.
    void cancel() {
        const std::lock_guard<std::mutex> lock(mutex_);
        cancelled_ = true;
        items_.clear();
        filled_.notify_all();
        emptied_.notify_all();
    }
    /// What was taken may not be all there was.
    bool cancelled() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return cancelled_;
    }

    /// The most items held at any time, for reports.
    std::size_t most_held() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return most_held_;
    }

    /// For one producer's thread: done at the end of the scope, or cancels if an exception ends it.
    class Producer {
    public:
        explicit Producer(ChunkBuffer& buffer) : buffer_(buffer) {}
        Producer(const Producer&) = delete;
        Producer& operator=(const Producer&) = delete;
        ~Producer() {
            if (std::uncaught_exceptions() > exceptions_) buffer_.cancel();
            buffer_.producer_done();
        }

    private:
        ChunkBuffer& buffer_;
        int exceptions_ = std::uncaught_exceptions();
    };
    /// For one consumer's thread: cancels if an exception ends the scope.
    class Consumer {
    public:
        explicit Consumer(ChunkBuffer& buffer) : buffer_(buffer) {}
        Consumer(const Consumer&) = delete;
        Consumer& operator=(const Consumer&) = delete;
        ~Consumer() {
            if (std::uncaught_exceptions() > exceptions_) buffer_.cancel();
        }

    private:
        ChunkBuffer& buffer_;
        int exceptions_ = std::uncaught_exceptions();
    };

private:
    std::optional<T> take_first() {
        if (cancelled_ || items_.empty()) return std::nullopt;
        std::optional<T> item(std::move(items_.front()));
        items_.pop_front();
        emptied_.notify_one();
        return item;
    }

    mutable std::mutex mutex_;
    std::condition_variable filled_, emptied_;
    std::deque<T> items_;
    std::size_t most_, producers_, most_held_ = 0;
    bool cancelled_ = false;
};

}  // namespace clinch::detail
