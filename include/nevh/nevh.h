/* nevh: write the Hamiltonian, get the motion.
   SPDX-License-Identifier: GPL-3.0-or-later

   The umbrella header.  Apart from it: <nevh/body.h>, by which a term gets its
   SIMD and complex forms, <nevh/gsl.h> for users of GSL's solvers,
   <nevh/extend.h> for authors of integrators. */
#ifndef NEVH_H
#define NEVH_H

#include <nevh/binding.h>
#include <nevh/certain.h>
#include <nevh/chaos.h>
#include <nevh/confirm.h>
#include <nevh/diagnose.h>
#include <nevh/ensemble.h>
#include <nevh/frequencies.h>
#include <nevh/gradient.h>
#include <nevh/integrator.h>
#include <nevh/loop.h>
#include <nevh/models.h>
#include <nevh/probe.h>
#include <nevh/reference.h>
#include <nevh/run.h>
#include <nevh/scene.h>
#include <nevh/section.h>
#include <nevh/shadow.h>
#include <nevh/status.h>
#include <nevh/sweep.h>
#include <nevh/system.h>
#include <nevh/timing.h>
#include <nevh/transform.h>

#endif
