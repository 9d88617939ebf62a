// How many compute units the broad phase has while the rest works on the narrow phase [thesis 6.1.2].
#pragma once

#include <cstdint>
#include <vector>

namespace clinch::detail {

/// Moves compute units from the phase that is done early to the one that keeps it waiting. Both phases work at the same
/// time, so a step takes as long as the longer one. One thread.
///
/// Checked at every step after a change; while nothing changes the interval doubles, up to a longest one. A phase's
/// work (time * units) that leaves where it was by more than 10 %, or a scene of another size, is a change. It moves
/// where the phases' work, shared evenly, promises to gain more than 4 %, and back only if measured to have been faster
/// there: two neighbouring splits are not exchanged for ever.
class PhaseBalance {
public:
    /// Seconds each phase was at work in a step, without what it waited for the other.
    struct Times {
        double broad, narrow;
    };

    /// Begins with `broad_units` of `units` (0: half). Throws Error (InvalidArgument) unless each phase has at least
    /// one unit and `longest_interval` is 1 or more.
    explicit PhaseBalance(unsigned units, unsigned broad_units = 0, unsigned longest_interval = 16);

    /// The split for the next step; at least 1 each.
    unsigned broad_units() const { return broad_units_; }
    unsigned narrow_units() const { return units_ - broad_units_; }
    /// Whether the next step will be checked; if measuring costs something, only these steps need it.
    bool checks_now() const { return countdown_ == 0; }
    /// Steps from one check to the next, at present.
    unsigned interval() const { return interval_; }
    /// How often the split was moved.
    std::uint64_t moves() const { return moves_; }

    /// A step has passed with this split and these times. Those of steps that are not checked may be given too: a
    /// marked change is then seen at once. Times that are negative, not finite or both 0 count as not measured.
    void measured(Times times);
    /// A step has passed that was not measured.
    void passed();
    /// Once before a step, whenever known: a size that differs by more than 10 % from the one at the last change is
    /// one.
    void scene_size(std::uint64_t bodies);

private:
    // One phase's seconds with the present split: smoothed, with its trend (Holt's method).
    struct Phase {
        double now = 0.0, a_step = 0.0;
        double at_change = 0.0, at_check = 0.0;  // what it was when last a change was seen, and at the last check
        double exponent = 1.0;                   // seconds are as units^-exponent
        double moved = 0.0;  // log(units after / before) of a move that was not measured yet; else 0

        void scale(double factor);
        double learn_exponent(double measured, unsigned steps);
        void follow(double measured, unsigned steps);
        double with(unsigned now_units, unsigned then_units) const;
    };
    struct Known {
        double seconds = 0.0;              // a step with this split, averaged
        double broad = 0.0, narrow = 0.0;  // what the phases would have taken then with the present split
        unsigned count = 0;                // of measured steps
    };

    void changed();
    void check();
    bool holds(const Known& known) const;
    void move(unsigned broad);
    double promised(unsigned broad) const;

    unsigned units_, broad_units_, longest_;
    unsigned interval_ = 1, countdown_ = 0, unmeasured_ = 0;
    std::uint64_t moves_ = 0, bodies_ = 0;
    Phase broad_, narrow_;
    bool fresh_ = true;         // nothing was measured yet
    std::vector<Known> known_;  // by broad units
};

}  // namespace clinch::detail
