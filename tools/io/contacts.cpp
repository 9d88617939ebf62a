#include "tools/io/contacts.hpp"

#include <array>
#include <string>

#include "tools/io/block_writer.hpp"
#include "tools/io/npy.hpp"

namespace clinch::io {
namespace {

// The columns between a, b and feature.
constexpr std::array<const char*, 11> float_columns{"ax", "ay", "az", "bx",       "by",   "bz",
                                                    "nx", "ny", "nz", "distance", "error"};

std::array<double, float_columns.size()> floats_of(const Contact& c) {
    return {c.on_a.x,   c.on_a.y,   c.on_a.z,   c.on_b.x,   c.on_b.y, c.on_b.z,
            c.normal.x, c.normal.y, c.normal.z, c.distance, c.error};
}

void write_csv(BlockWriter& out, View<const Contact> contacts) {
    out.text("a,b");
    for (const char* const name : float_columns) {
        out.character(',');
        out.text(name);
    }
    out.text(",feature\n");
    for (const Contact& contact : contacts) {
        out.number(contact.a);
        out.character(',');
        out.number(contact.b);
        for (const double x : floats_of(contact)) {
            out.character(',');
            out.number(x);
        }
        out.character(',');
        out.number(contact.feature);
        out.character('\n');
    }
}

void write_npy(BlockWriter& out, View<const Contact> contacts) {
    std::string columns = "[('a', '<u4'), ('b', '<u4')";
    for (const char* const name : float_columns) columns += std::string(", ('") + name + "', '<f8')";
    out.text(npy_header(columns + ", ('feature', '<u4')]", {contacts.size()}));
    for (const Contact& contact : contacts) {
        out.bytes(contact.a);
        out.bytes(contact.b);
        out.bytes(floats_of(contact));
        out.bytes(contact.feature);
    }
}

}  // namespace

void write_contacts(OutputFile& file, TableFormat format, View<const Contact> contacts) {
    BlockWriter out(file);
    if (format == TableFormat::Csv)
        write_csv(out, contacts);
    else
        write_npy(out, contacts);
    out.finish();
}

}  // namespace clinch::io
