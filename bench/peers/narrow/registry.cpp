#include "bench/peers/narrow/peer.hpp"

namespace clinch::peers::narrow {

std::unique_ptr<Peer> make_clinch(const Batch& batch, Question question, const Way& way);
std::unique_ptr<Peer> make_copy(const Batch& batch, Question question);
#ifdef CLINCH_PEER_LIBCCD
std::unique_ptr<Peer> make_libccd_gjk(const Batch& batch, Question question);
std::unique_ptr<Peer> make_libccd_mpr(const Batch& batch, Question question);
#endif
#ifdef CLINCH_PEER_FCL
std::unique_ptr<Peer> make_fcl_libccd(const Batch& batch, Question question);
std::unique_ptr<Peer> make_fcl_indep(const Batch& batch, Question question);
#endif
#ifdef CLINCH_PEER_BULLET
std::unique_ptr<Peer> make_bullet(const Batch& batch, Question question);
std::unique_ptr<Peer> make_bullet_gjkepa(const Batch& batch, Question question);
#endif
#ifdef CLINCH_PEER_ODE
std::unique_ptr<Peer> make_ode(const Batch& batch, Question question);
#endif

namespace {

using Make = std::function<std::unique_ptr<Peer>(const Batch&, Question)>;

#ifdef CLINCH_PEER_LIBCCD
const Make libccd_gjk = make_libccd_gjk, libccd_mpr = make_libccd_mpr;
#else
const Make libccd_gjk, libccd_mpr;
#endif
#ifdef CLINCH_PEER_FCL
const Make fcl_libccd = make_fcl_libccd, fcl_indep = make_fcl_indep;
#else
const Make fcl_libccd, fcl_indep;
#endif
#ifdef CLINCH_PEER_BULLET
const Make bullet = make_bullet, bullet_gjkepa = make_bullet_gjkepa;
#else
const Make bullet, bullet_gjkepa;
#endif
#ifdef CLINCH_PEER_ODE
const Make ode = make_ode;
#else
const Make ode;
#endif

Make clinch_of(const Way& way) {
    return [way](const Batch& batch, Question question) { return make_clinch(batch, question, way); };
}

}  // namespace

std::vector<PeerRow> peer_rows() {
    return {
        {"clinch", Group::Clinch, true, "", clinch_of({0.5})},
        {"clinch/all-cores", Group::Clinch, false, "", clinch_of({0.5})},
        {"clinch/fast", Group::Clinch, true, "", clinch_of({0.0})},
        {"clinch/points", Group::Clinch, true, "", clinch_of({0.5, 4})},
        {"clinch/exact", Group::Clinch, true, "", clinch_of({1.0})},
        {"clinch/warm", Group::Clinch, true, "", clinch_of({0.5, 1, true})},
        {"fcl-libccd", Group::Library, true, "libfcl-dev", fcl_libccd},
        {"fcl-indep", Group::Library, true, "libfcl-dev", fcl_indep},
        {"libccd-gjk", Group::Library, true, "libccd-dev", libccd_gjk},
        {"libccd-mpr", Group::Library, true, "libccd-dev", libccd_mpr},
        {"bullet", Group::Library, true, "libbullet-dev", bullet},
        {"bullet-gjkepa", Group::Library, true, "libbullet-dev", bullet_gjkepa},
        {"ode", Group::Library, true, "libode-dev", ode},
        {"copy", Group::Yardstick, true, "", make_copy},
    };
}

}  // namespace clinch::peers::narrow
