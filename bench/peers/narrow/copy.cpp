// The yardstick of pairs that need little arithmetic: moving the bytes of a pair, its number and two bodies in, one
// contact out, and nothing else.
#include "bench/peers/narrow/peer.hpp"
#include "clinch/aabb.hpp"
#include "clinch/contact.hpp"

namespace clinch::peers::narrow {
namespace {

// As long as the library's own record of a body.
struct Body {
    float numbers[16] = {};
};

class Copy : public Peer {
public:
    explicit Copy(const Batch& batch)
        : pairs_(batch.pairs()), bodies_(batch.pose.size()), contacts_(batch.pairs()), answers_(batch.pairs()) {
        for (std::uint32_t i = 0; i < batch.pairs(); ++i) pairs_[i] = {2 * i, 2 * i + 1};
    }

    void run() override {
        for (std::size_t i = 0; i < contacts_.size(); ++i) {
            const Pair pair = pairs_[i];
            const Body &a = bodies_[pair.a], &b = bodies_[pair.b];
            Contact contact;
            contact.a = pair.a;
            contact.b = pair.b;
            contact.on_a = {double{a.numbers[0]}, double{a.numbers[1]}, double{a.numbers[2]}};
            contact.on_b = {double{b.numbers[0]}, double{b.numbers[1]}, double{b.numbers[2]}};
            contacts_[i] = contact;
        }
    }
    const std::vector<Answer>& answers() override { return answers_; }

private:
    std::vector<Pair> pairs_;
    std::vector<Body> bodies_;
    std::vector<Contact> contacts_;
    std::vector<Answer> answers_;  // none
};

}  // namespace

std::unique_ptr<Peer> make_copy(const Batch& batch, Question) {
    return std::make_unique<Copy>(batch);
}

}  // namespace clinch::peers::narrow
