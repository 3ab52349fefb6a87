#include "scenarios/table.h"

const cpl_scenario scn_table[] = {
    {"collision", "scenarios", "a particle hits a cube, six mass ratios ([L18] Section 3.1)", scn_collision, NULL},
    {"spring_damper", "scenarios", "a box of particles on a spring and damper ([L18] Section 3.3)", scn_spring_damper,
     scn_spring_damper_compare},
    {0},
};
