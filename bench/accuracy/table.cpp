#include <cstdio>
#include <ostream>

#include "bench/accuracy/report.hpp"

namespace clinch::accuracy {
namespace {

const CandidateResult* on_device(const CellResult& cell, const Title& title) {
    if (title.routine != "own") return nullptr;
    for (const CandidateResult& c : cell.candidates)
        if (c.title.where == "device" && c.title.bits == title.bits) return &c;
    return nullptr;
}

// In cells without a closed form the general routine is their own: those with tolerances are variants of it.
bool has_closed_form(const CellResult& cell) {
    for (const CandidateResult& c : cell.candidates)
        if (c.title.routine == "gjk-epa" && c.title.tolerance < 0) return true;
    return cell.b == test::Kind::plane || cell.a == test::Kind::plane;
}

}  // namespace

void write_table(const std::vector<CellResult>& cells, std::ostream& out) {
    out << "// Written by clinch_accuracy --table. Rows of Measured: classes, routine, bits, tolerance, ns a pair on a "
           "device\n"
           "// and on the host, worst actual error, promised error of half and of 99 % of the pairs.\n";
    for (const CellResult& cell : cells) {
        out << "// " << classes_of(cell) << '\n';
        const bool closed = has_closed_form(cell);
        for (const CandidateResult& c : cell.candidates) {
            if (!c.promises || c.title.where == "device") continue;
            const CandidateResult* device = on_device(cell, c.title);
            const bool general = closed && c.title.routine != "own";
            char row[200];
            std::snprintf(row, sizeof row, "{%d, %d, Routine::%s, %u, %.1ef, %.1ff, %.1ff, %.1ef, %.1ef, %.1ef},\n",
                          static_cast<int>(cell.a), static_cast<int>(cell.b), general ? "general" : "own", c.title.bits,
                          c.title.tolerance, device == nullptr ? 0.0 : device->all.ns, c.all.ns, c.all.worst,
                          c.usual.promised_median, c.usual.promised_p99);
            out << row;
        }
    }
}

}  // namespace clinch::accuracy
