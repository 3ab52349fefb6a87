/* x */
typedef int dem_state_unused;
