// nevh: Boost.odeint as a peer, with everything inline.
// SPDX-License-Identifier: GPL-3.0-or-later
#include "peer.h"
#include <array>
#include <boost/numeric/odeint.hpp>
#include <boost/numeric/odeint/stepper/symplectic_rkn_sb3a_m4_mclachlan.hpp>
#include <boost/version.hpp>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace odeint = boost::numeric::odeint;

namespace {

struct request {
    const problem *p;
    double setting;
    bool (*go)(const request &, double y[]);
};

typedef bool (*go_fn)(const request &, double y[]);

/* One function for each problem, NULL where the method does not fit. */
struct table {
    go_fn go[PROBLEMS];
};

#define PROBLEM(id, dimension)                                                 \
    struct id##_problem {                                                      \
        enum { n = dimension };                                                \
        static void all(const double y[], double dy[]) { id##_all(y, dy); }    \
    };
#define HALVES(id, dimension)                                                  \
    struct id##_halves {                                                       \
        enum { n = dimension };                                                \
        static void all(const double y[], double dy[]) { id##_all(y, dy); }    \
        static void force(const double q[], double f[]) { id##_force(q, f); }  \
        static void velocity(const double p[], double v[]) {                   \
            id##_velocity(p, v);                                               \
        }                                                                      \
    };
SEPARABLE_PROBLEMS(HALVES)
PROBLEM(double_pendulum, 2)

template <class P> using state = std::array<double, 2 * P::n>;
template <class P> using half = std::array<double, P::n>;

template <class P> struct all {
    void operator()(const state<P> &y, state<P> &dy, double) const {
        P::all(y.data(), dy.data());
    }
};
template <class P> struct force {
    void operator()(const half<P> &q, half<P> &f) const {
        P::force(q.data(), f.data());
    }
};
template <class P> struct velocity {
    void operator()(const half<P> &p, half<P> &v) const {
        P::velocity(p.data(), v.data());
    }
};

template <class P, class Stepper> bool fixed(const request &r, double y[]) {
    Stepper stepper;
    state<P> x;
    size_t steps = (size_t)r.setting;
    double h = r.p->t_end / r.setting;
    std::memcpy(x.data(), r.p->start, sizeof x);
    for (size_t i = 0; i < steps; i++)
        stepper.do_step(all<P>(), x, (double)i * h, h);
    std::memcpy(y, x.data(), sizeof x);
    return true;
}

template <class P, class Stepper>
bool symplectic(const request &r, double y[]) {
    Stepper stepper;
    half<P> q, p;
    size_t steps = (size_t)r.setting;
    double h = r.p->t_end / r.setting;
    std::memcpy(q.data(), r.p->start, sizeof q);
    std::memcpy(p.data(), r.p->start + P::n, sizeof p);
    for (size_t i = 0; i < steps; i++)
        stepper.do_step(std::make_pair(velocity<P>(), force<P>()),
                        std::make_pair(std::ref(q), std::ref(p)),
                        (double)i * h, h);
    std::memcpy(y, q.data(), sizeof q);
    std::memcpy(y + P::n, p.data(), sizeof p);
    return true;
}

/* Works with velocities and accelerations. */
template <class P> struct acceleration {
    void operator()(const half<P> &q, const half<P> &, half<P> &a,
                    double) const {
        half<P> f;
        P::force(q.data(), f.data());
        P::velocity(f.data(), a.data());
    }
};
template <class P, class Stepper> bool verlet(const request &r, double y[]) {
    Stepper stepper;
    half<P> q, v;
    size_t steps = (size_t)r.setting;
    double h = r.p->t_end / r.setting;
    std::memcpy(q.data(), r.p->start, sizeof q);
    P::velocity(r.p->start + P::n, v.data());
    for (size_t i = 0; i < steps; i++)
        stepper.do_step(acceleration<P>(),
                        std::make_pair(std::ref(q), std::ref(v)),
                        (double)i * h, h);
    half<P> ones, inverse;
    ones.fill(1);
    P::velocity(ones.data(), inverse.data());
    for (size_t k = 0; k < P::n; k++) {
        y[k] = q[k];
        y[P::n + k] = v[k] / inverse[k];
    }
    return true;
}

template <class P, class Stepper> bool adaptive(const request &r, double y[]) {
    state<P> x;
    std::memcpy(x.data(), r.p->start, sizeof x);
    try {
        odeint::integrate_adaptive(
            odeint::make_controlled<Stepper>(r.p->size * r.setting,
                                             r.setting), all<P>(), x,
            0., r.p->t_end, r.p->t_end / 1000);
    } catch (...) {
        return false;
    }
    std::memcpy(y, x.data(), sizeof x);
    return true;
}

template <class P, class Stepper>
bool extrapolation(const request &r, double y[]) {
    Stepper stepper(r.p->size * r.setting, r.setting);
    state<P> x;
    std::memcpy(x.data(), r.p->start, sizeof x);
    try {
        odeint::integrate_adaptive(stepper, all<P>(), x, 0., r.p->t_end,
                                   r.p->t_end / 1000);
    } catch (...) {
        return false;
    }
    std::memcpy(y, x.data(), sizeof x);
    return true;
}

template <class P>
using mclachlan = odeint::symplectic_rkn_sb3a_mclachlan<half<P>>;
template <class P> using m4 = odeint::symplectic_rkn_sb3a_m4_mclachlan<half<P>>;
template <class P> using euler = odeint::symplectic_euler<half<P>>;
template <class P> using leapfrog = odeint::velocity_verlet<half<P>>;
template <class P> using rk4 = odeint::runge_kutta4<state<P>>;
template <class P> using dopri5 = odeint::runge_kutta_dopri5<state<P>>;
template <class P> using fehlberg78 = odeint::runge_kutta_fehlberg78<state<P>>;
template <class P> using bulirsch_stoer = odeint::bulirsch_stoer<state<P>>;

#define ALL(how, stepper)                                                      \
    {{how<pendulum_halves, stepper<pendulum_halves>>,                          \
      how<double_pendulum_problem, stepper<double_pendulum_problem>>,          \
      how<kepler_halves, stepper<kepler_halves>>,                              \
      how<henon_heiles_halves, stepper<henon_heiles_halves>>,                  \
      how<outer_sun_halves, stepper<outer_sun_halves>>}}
#define SEPARABLE(how, stepper)                                                \
    {{how<pendulum_halves, stepper<pendulum_halves>>, nullptr,                 \
      how<kepler_halves, stepper<kepler_halves>>,                              \
      how<henon_heiles_halves, stepper<henon_heiles_halves>>,                  \
      how<outer_sun_halves, stepper<outer_sun_halves>>}}

const table mclachlan_table = SEPARABLE(symplectic, mclachlan);
const table m4_table = SEPARABLE(symplectic, m4);
const table euler_table = SEPARABLE(symplectic, euler);
const table verlet_table = SEPARABLE(verlet, leapfrog);
const table rk4_table = ALL(fixed, rk4);
const table dopri5_table = ALL(fixed, dopri5);
const table fehlberg78_table = ALL(fixed, fehlberg78);
const table dopri5_adaptive_table = ALL(adaptive, dopri5);
const table fehlberg78_adaptive_table = ALL(adaptive, fehlberg78);
const table bulirsch_stoer_table = ALL(extrapolation, bulirsch_stoer);

void *open_run(const method *m, const problem *p, double setting) {
    go_fn go = ((const table *)m->data)->go[p - problems];
    return go ? new request{p, setting, go} : nullptr;
}

bool run(void *data, double y[], double *) {
    const request *r = (const request *)data;
    return r->go(*r, y);
}

void close_run(void *data) {
    delete (request *)data;
}

const method methods[] = {
    {"symplectic euler", false, open_run, run, close_run, &euler_table, 1},
    {"velocity verlet", false, open_run, run, close_run, &verlet_table, 2},
    {"rkn sb3a", false, open_run, run, close_run, &mclachlan_table, 4},
    {"rkn sb3a m4", false, open_run, run, close_run, &m4_table, 4},
    {"rk4", false, open_run, run, close_run, &rk4_table, 4},
    {"dopri5", false, open_run, run, close_run, &dopri5_table, 5},
    {"fehlberg78", false, open_run, run, close_run, &fehlberg78_table, 8},
    {"dopri5, adaptive", true, open_run, run, close_run, &dopri5_adaptive_table,
     5},
    {"fehlberg78, adaptive", true, open_run, run, close_run,
     &fehlberg78_adaptive_table, 8},
    {"bulirsch-stoer", true, open_run, run, close_run, &bulirsch_stoer_table,
     0},
};

} // namespace

extern "C" const library boost_library = {
    "Boost.odeint", BOOST_LIB_VERSION, false,
    sizeof methods / sizeof *methods, methods, false};
