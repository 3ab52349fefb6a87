/* Reading the scene section "dem" into a model. */
#ifndef DEM_MODEL_READ_H
#define DEM_MODEL_READ_H

#include "dem/model.h"

/* Fill *model (zeroed) from the assignment. The first error is left in err. */
void dem_model_read(dem_model *model, const tdm_assignment *assignment, tdm_error *err);

/* The key "material" of an object as an index; 0 after an error. */
int dem_read_material(const dem_model *model, tdm_object *o);

#endif
