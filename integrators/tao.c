/* nevh: Tao's schemes, composed of the one of order 2.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "schemes_private.h"
#include "tao_private.h"

static const nevh__composition once = {0, 0};
/* 1 / (2 - 2^(1/3)) */
static const long double jump[] = {1.351207191959657634047687808971460826922L};
static const nevh__composition triple_jump = {1, jump};
static const long double yoshida[] = {
    0.7845136104775572638194976338663498757768L,
    0.2355732133593581336847931829785346016865L,
    -1.177679984178871006946415680964315734639L,
};
static const nevh__composition yoshida_a = {3, yoshida};
static const long double kahan_li[] = {
    0.3921614440073141392792505574226714038049L,
    0.3325991367893594385997486375000496468816L,
    -0.7062461725576393598099648195492564593955L,
    0.08221359629355080023149044810205633110329L,
};
static const nevh__composition kahan_li_9 = {4, kahan_li};
#define G 1.351207191959657634047687808971460826922L
#define F 1.174671758089363409829893505838L
static const long double nine[] = {F*G, F*(1-2*G), F*G, (1-2*F)*G};
static const nevh__composition jump_of_jumps = {4, nine};
static const long double suzuki[] = {0.4144907717943757371423L,0.4144907717943757371423L};
static const nevh__composition suz = {2, suzuki};

#define TAO(id, o, s, c) const nevh_integrator nevh__##id = { .name = #id, .aliases = "", .source = "M. Tao, Phys", .order = o, .stages = s, .gradients = 3*s, .symplectic = NEVH_DOUBLED, .symmetric = NEVH_DOUBLED, .explicit_form = NEVH_YES, .kernel=&nevh__tao_kernel, .table = &c}
TAO(tao2, 2, 1, once);
NEVH__PUBLISH(tao2);
TAO(tao4, 4, 3, triple_jump);
NEVH__PUBLISH(tao4);
TAO(tao6, 6, 7, yoshida_a);
NEVH__PUBLISH(tao6);
TAO(tao6k, 6, 9, kahan_li_9);
TAO(tao6j, 6, 9, jump_of_jumps);
TAO(tao4s, 4, 5, suz);
