// Lists of pairs that the threads of oneTBB fill without waiting for each other.
#pragma once

#include <tbb/task_arena.h>

#include <cstddef>
#include <vector>

#include "bench/peers/peer.hpp"

namespace clinch::peers {

/// One list a thread of the arena that runs, for at most `threads` of them.
class ThreadLists {
public:
    explicit ThreadLists(unsigned threads) : lists_(threads + 1) {}

    /// The calling thread's list.
    std::vector<Pair>& mine() {
        const int index = tbb::this_task_arena::current_thread_index();  // -1: no thread of an arena
        return lists_.at(static_cast<std::size_t>(index) + 1).pairs;
    }
    /// Empties the lists, keeps their memory.
    void clear() {
        for (List& list : lists_) list.pairs.clear();
    }
    Lists views() const {
        Lists views;
        for (const List& list : lists_) views.emplace_back(list.pairs);
        return views;
    }

private:
    struct alignas(128) List {
        std::vector<Pair> pairs;
    };
    std::vector<List> lists_;
};

}  // namespace clinch::peers
