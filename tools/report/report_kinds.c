/* nevh report: the kinds of parts, and which scenes have them.
   SPDX-License-Identifier: GPL-3.0-or-later */
#include "report_private.h"

static bool always(nevh_scene *scene) {
    (void)scene;
    return true;
}

static bool has_picture(nevh_scene *scene) {
    return nevh_scene_part_count(scene) > 0;
}

static bool has_sections(nevh_scene *scene) {
    return nevh_scene_section_count(scene) > 0;
}

static bool is_driven(nevh_scene *scene) {
    return !(nevh_system_traits(nevh_scene_system(scene)) & NEVH_AUTONOMOUS);
}

/* Levels of H are lines of the plane, which orbits of a driven system leave. */
static bool has_plane(nevh_scene *scene) {
    return nevh_scene_dof(scene) == 1 && !is_driven(scene);
}

/* Orbits that can be chaotic, and not so many coordinates that it takes long to
   tell. */
static bool has_room(nevh_scene *scene) {
    enum { MOST = 40 };
    size_t n = nevh_scene_dof(scene);
    return (n > 1 || is_driven(scene)) && n <= MOST;
}

static bool has_no_picture(nevh_scene *scene) {
    return !has_picture(scene);
}

/* A section of one degree of freedom without a drive is one point, with the error of
   the scheme. */
static bool tells_in_sections(nevh_scene *scene) {
    return has_sections(scene) &&
           (nevh_scene_dof(scene) > 1 || is_driven(scene));
}

const kind_of_part report_kinds[] = {
    {.title = "Energy errors",
     .about =
         "Each row is an integrator at one step. Bounded errors stay; drifting "
         "errors grow with time. The picture shows the error against time.",
     .arguments = "compare",
     .of = &compare_command,
     .wanted = always,
     .usual = always,
     .rows = true,
     .draws = true},
    {.title = "The motion",
     .about = "Paths of the bodies: the reference beside the first integrator.",
     .arguments = "run --plot-kind configuration",
     .of = &run_command,
     .wanted = has_picture,
     .usual = always,
     .kind = PLOT_KIND_configuration,
     .draws = true},
    {.title = "A symplectic scheme beside rk4",
     .about = "Both take the same dt: the smallest at which rk4's loss can be "
              "seen within the animation.",
     .arguments = "compare",
     .wanted = has_picture,
     .usual = always},
    {.title = "Phase plane",
     .about = "A coordinate and its momentum: the reference beside the first "
              "integrator.",
     .arguments = "run --plot-kind phase",
     .of = &run_command,
     .wanted = always,
     .usual = has_no_picture,
     .kind = PLOT_KIND_phase,
     .draws = true},
    {.title = "Portrait",
     .about = "Orbits over level curves of H, a panel for each integrator.",
     .arguments = "portrait",
     .of = &portrait_command,
     .wanted = has_plane,
     .usual = always,
     .draws = true},
    {.title = "Sections",
     .about = "Points where the orbit crosses the section.",
     .arguments = "section",
     .of = &section_command,
     .wanted = has_sections,
     .usual = tells_in_sections,
     .draws = true},
    {.title = "Order and chaos",
     .about = "The Lyapunov exponent of the orbit from the scene's start: how "
              "fast orbits near by separate.",
     .arguments = "chaos --starts 2 --budget 4",
     .of = &chaos_command,
     .wanted = has_room,
     .usual = always,
     .rows = true,
     .budget = 4},
    {.title = "What accuracy costs",
     .about =
         "Processor time for each digit. The picture is the work-precision "
         "diagram: lower left is better.",
     .arguments = "cost --budget 5",
     .of = &cost_command,
     .wanted = always,
     .usual = always,
     .rows = true,
     .draws = true,
     .budget = 5},
    {.title = "Effects",
     .about = "What each effect reads and costs. Effects that are off cost "
              "nothing.",
     .arguments = "effects",
     .of = &effects_command,
     .wanted = always,
     .rows = true},
    {.title = "Gradients",
     .about =
         "Error and time of the gradient by each method. Large differences "
         "suffer from truncation, small ones from rounding.",
     .arguments = "gradients",
     .of = &gradients_command,
     .wanted = always,
     .rows = true,
     .draws = true},
    {.title = "Properties of H",
     .about = "Tested numerically at states around the start.",
     .arguments = "check",
     .of = &check_command,
     .wanted = always,
     .rows = true},
    {0}};
