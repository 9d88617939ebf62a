#include "bench/peers/peer.hpp"

namespace clinch::peers {

std::unique_ptr<Peer> make_clinch(const std::string& algorithm, Order order);
std::unique_ptr<Peer> make_boost_rtree(const Setup& setup);
#ifdef CLINCH_PEER_CGAL
std::unique_ptr<Peer> make_cgal(const Setup& setup);
std::unique_ptr<Peer> make_cgal_parallel(const Setup& setup);
#endif
#ifdef CLINCH_PEER_EMBREE
std::unique_ptr<Peer> make_embree(const Setup& setup);
std::unique_ptr<Peer> make_embree_fast_build(const Setup& setup);
#endif
#ifdef CLINCH_PEER_BULLET
std::unique_ptr<Peer> make_bullet_dbvt(const Setup& setup);
#endif
#ifdef CLINCH_PEER_FCL
std::unique_ptr<Peer> make_fcl(const Setup& setup);
#endif
#ifdef CLINCH_PEER_ODE
std::unique_ptr<Peer> make_ode(const Setup& setup);
#endif
#ifdef CLINCH_PEER_BULLET3
std::unique_ptr<Peer> make_bullet3_sap(const Setup& setup);
std::unique_ptr<Peer> make_bullet3_grid(const Setup& setup);
std::unique_ptr<Peer> make_bullet3_bvh(const Setup& setup);
#endif
#ifdef CLINCH_PEER_AVX512
std::unique_ptr<Peer> make_native_grid(const Setup& setup);
std::unique_ptr<Peer> make_native_sweep(const Setup& setup);
#endif

namespace {

using Make = std::function<std::unique_ptr<Peer>(const Setup&)>;

#ifdef CLINCH_PEER_CGAL
const Make cgal = make_cgal, cgal_parallel = make_cgal_parallel;
#else
const Make cgal, cgal_parallel;
#endif
#ifdef CLINCH_PEER_EMBREE
const Make embree = make_embree, embree_fast_build = make_embree_fast_build;
#else
const Make embree, embree_fast_build;
#endif
#ifdef CLINCH_PEER_BULLET
const Make bullet_dbvt = make_bullet_dbvt;
#else
const Make bullet_dbvt;
#endif
#ifdef CLINCH_PEER_FCL
const Make fcl = make_fcl;
#else
const Make fcl;
#endif
#ifdef CLINCH_PEER_ODE
const Make ode = make_ode;
#else
const Make ode;
#endif
#ifdef CLINCH_PEER_BULLET3
const Make bullet3_sap = make_bullet3_sap, bullet3_grid = make_bullet3_grid, bullet3_bvh = make_bullet3_bvh;
#else
const Make bullet3_sap, bullet3_grid, bullet3_bvh;
#endif
#ifdef CLINCH_PEER_AVX512
const Make native_grid = make_native_grid, native_sweep = make_native_sweep;
#else
const Make native_grid, native_sweep;
#endif

}  // namespace

std::vector<PeerRow> peer_rows() {
    std::vector<PeerRow> rows;
    std::vector<std::string> algorithms = broad_phase_names();
    algorithms.insert(algorithms.begin(), "auto");
    for (const std::string& name : algorithms)
        for (const Order order : {Order::Sorted, Order::Any})
            rows.push_back({"clinch/" + name + (order == Order::Any ? "/any" : "/sorted"), Group::Clinch, true, "",
                            [name, order](const Setup&) { return make_clinch(name, order); }});
    rows.push_back({"cgal", Group::Library, false, "libcgal-dev", cgal});
    rows.push_back({"cgal-parallel", Group::Library, true, "libcgal-dev libtbb-dev", cgal_parallel});
    rows.push_back({"embree", Group::Library, true, "libembree-dev libtbb-dev", embree});
    rows.push_back({"embree-fast-build", Group::Library, true, "libembree-dev libtbb-dev", embree_fast_build});
    rows.push_back({"bullet-dbvt", Group::Library, false, "libbullet-dev", bullet_dbvt});
    rows.push_back({"fcl-tree", Group::Library, false, "libfcl-dev", fcl});
    rows.push_back({"ode-sap", Group::Library, false, "libode-dev", ode});
    rows.push_back({"boost-rtree", Group::Library, true, "libboost-dev", make_boost_rtree});
    rows.push_back({"bullet3-cl-sap", Group::Lossy, true, "libbullet-dev", bullet3_sap});
    rows.push_back({"bullet3-cl-grid", Group::Lossy, true, "libbullet-dev", bullet3_grid});
    rows.push_back({"bullet3-cl-bvh", Group::Lossy, true, "libbullet-dev", bullet3_bvh});
    rows.push_back({"native-grid", Group::Yardstick, true, "a processor with AVX-512", native_grid});
    rows.push_back({"native-sweep", Group::Yardstick, true, "a processor with AVX-512", native_sweep});
    return rows;
}

}  // namespace clinch::peers
