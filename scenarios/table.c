#include "scenarios/table.h"

const cpl_scenario scn_table[] = {
    {.name = "collision",
     .group = "scenarios",
     .summary = "a particle hits a cube, six mass ratios ([L18] Section 3.1)",
     .verify = scn_collision},
    {.name = "spring_damper",
     .group = "scenarios",
     .summary = "a box of particles on a spring and damper ([L18] Section 3.3)",
     .verify = scn_spring_damper,
     .compare = scn_spring_damper_compare,
     .state = {"x", "v"},
     .load = "F"},
    {0},
};
