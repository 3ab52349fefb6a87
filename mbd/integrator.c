#include "mbd/integrator.h"

const mbd_formulation mbd_formulation_table[MBD_FORMULATIONS] = {
    [MBD_GGL] = {"ggl", &mbd_ida},
    [MBD_INDEX3] = {"index3", &mbd_ida},
    [MBD_ONE_STEP] = {"one_step", &mbd_one_step},
};
