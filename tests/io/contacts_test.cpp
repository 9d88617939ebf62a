// Contacts into files.
#include "tools/io/contacts.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/io/temp_folder.hpp"
#include "tests/random.hpp"

namespace {

using namespace clinch::test;
using clinch::Contact;
using clinch::io::TableFormat;

const std::string header = "a,b,ax,ay,az,bx,by,bz,nx,ny,nz,distance,error,feature\n";
const std::string descr =
    "[('a', '<u4'), ('b', '<u4'), ('ax', '<f8'), ('ay', '<f8'), ('az', '<f8'), ('bx', '<f8'), ('by', '<f8'), "
    "('bz', '<f8'), ('nx', '<f8'), ('ny', '<f8'), ('nz', '<f8'), ('distance', '<f8'), ('error', '<f8'), "
    "('feature', '<u4')]";

std::string written(const TempFolder& folder, TableFormat format, const std::vector<Contact>& contacts) {
    clinch::io::OutputFile file(folder / "out");
    clinch::io::write_contacts(file, format, contacts);
    file.commit();
    return content(folder / "out");
}

Contact some_contact() {
    Contact c;
    c.a = 3;
    c.b = 4294967294u;
    c.feature = 77;
    c.on_a = {0.5, -1.25, 0.1};
    c.on_b = {1e300, 5e-324, -0.0};
    c.normal = {0.0, 1.0, -1.0};
    c.distance = -0.0625;
    c.error = 1e-17;
    return c;
}

/// The numbers of a contact in the order of the columns, as 32-bit words.
std::vector<std::uint32_t> words(const Contact& c) {
    std::vector<std::uint32_t> all{c.a, c.b};
    for (const double x : {c.on_a.x, c.on_a.y, c.on_a.z, c.on_b.x, c.on_b.y, c.on_b.z, c.normal.x, c.normal.y,
                           c.normal.z, c.distance, c.error}) {
        std::uint32_t halves[2];
        std::memcpy(halves, &x, sizeof x);
        all.insert(all.end(), {halves[0], halves[1]});
    }
    all.push_back(c.feature);
    return all;
}

/// NumPy's header of a version 1 file, made apart from the code that is tested.
std::string structured(const std::string& shape, const std::string& data) {
    std::string text = "{'descr': " + descr + ", 'fortran_order': False, 'shape': " + shape + ", }";
    while ((text.size() + 11) % 64 != 0) text += ' ';
    return npy_raw(text + '\n', data);
}

double random_number(Random& random) {
    for (;;) {
        const std::uint64_t bits = random.bits();
        double x = 0.0;
        std::memcpy(&x, &bits, sizeof x);
        if (std::isfinite(x)) return x;
    }
}

}  // namespace

TEST_CASE("contacts are written as .npy and .csv", "[host]") {
    const TempFolder folder;
    const Contact one = some_contact();
    CHECK(written(folder, TableFormat::Csv, {}) == header);
    CHECK(written(folder, TableFormat::Csv, {one}) ==
          header + "3,4294967294,0.5,-1.25,0.1,1e+300,5e-324,-0,0,1,-1,-0.0625,1e-17,77\n");
    CHECK(written(folder, TableFormat::Npy, {}) == structured("(0,)", ""));
    const std::string row = bytes(words(one));
    REQUIRE(row.size() == 100);
    CHECK(written(folder, TableFormat::Npy, {one, one}) == structured("(2,)", row + row));
}

TEST_CASE("contacts of any numbers read back to the same bits, and no row is lost between blocks", "[host]") {
    const std::uint64_t seed = 31;
    INFO("seed " << seed);
    Random random(seed);
    const TempFolder folder;
    std::vector<Contact> contacts(5000);
    std::string data;
    for (Contact& c : contacts) {
        c.a = static_cast<std::uint32_t>(random.bits());
        c.b = static_cast<std::uint32_t>(random.bits());
        c.feature = static_cast<std::uint32_t>(random.bits());
        for (double* const x : {&c.on_a.x, &c.on_a.y, &c.on_a.z, &c.on_b.x, &c.on_b.y, &c.on_b.z, &c.normal.x,
                                &c.normal.y, &c.normal.z, &c.distance, &c.error})
            *x = random_number(random);
        data += bytes(words(c));
    }
    CHECK(written(folder, TableFormat::Npy, contacts) == structured("(5000,)", data));

    const std::string csv = written(folder, TableFormat::Csv, contacts);
    REQUIRE(csv.compare(0, header.size(), header) == 0);
    const char* at = csv.c_str() + header.size();
    std::size_t wrong = 0;
    for (const Contact& c : contacts) {
        Contact read;
        const auto next = [&](double& x) {
            char* end = nullptr;
            x = std::strtod(at, &end);
            at = end + 1;
        };
        const auto next_whole = [&](std::uint32_t& x) {
            char* end = nullptr;
            x = static_cast<std::uint32_t>(std::strtoul(at, &end, 10));
            at = end + 1;
        };
        next_whole(read.a);
        next_whole(read.b);
        for (double* const x : {&read.on_a.x, &read.on_a.y, &read.on_a.z, &read.on_b.x, &read.on_b.y, &read.on_b.z,
                                &read.normal.x, &read.normal.y, &read.normal.z, &read.distance, &read.error})
            next(*x);
        next_whole(read.feature);
        wrong += words(read) == words(c) && at[-1] == '\n' ? 0u : 1u;
    }
    CHECK(wrong == 0);
    CHECK(at == csv.c_str() + csv.size());
}
