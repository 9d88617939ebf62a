#include "tools/io/pairs.hpp"

#include "tools/io/block_writer.hpp"
#include "tools/io/npy.hpp"

namespace clinch::io {
namespace {

void write_csv(OutputFile& file, View<const Pair> pairs) {
    BlockWriter out(file);
    out.text("a,b\n");
    for (const Pair& pair : pairs) {
        out.number(pair.a);
        out.character(',');
        out.number(pair.b);
        out.character('\n');
    }
    out.finish();
}

}  // namespace

void write_pairs(OutputFile& file, TableFormat format, View<const Pair> pairs) {
    if (format == TableFormat::Csv) {
        write_csv(file, pairs);
        return;
    }
    file.write(npy_header("<u4", {pairs.size(), 2}));
    file.write(pairs.data(), pairs.size() * sizeof(Pair));
}

}  // namespace clinch::io
