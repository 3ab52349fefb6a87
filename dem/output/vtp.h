/* Particles and walls for ParaView: one .vtp file (VTK XML, PolyData) each and time, and the .pvd file that lists them.
 *
 * Arrays are base64 of a 64-bit byte count and the little-endian numbers, so that the files are XML. They hold nothing
 * that differs between two runs of the same scene.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_VTP_H
#define DEM_OUTPUT_VTP_H

#include "dem/output/polygon.h"
#include "protocol/results/results.h"

/* particles_NNNNNN.vtp: points with radius, velocity, spin, id and material. */
tdm_status dem_vtp_particles(const tdm_results *results, int number, const dem_snapshot *snapshot, tdm_error *err);

/* walls_NNNNNN.vtp: polygons with the index of their body; with forces also, on triangles of meshes (NaN elsewhere),
 * `force` [N], `pressure` [Pa], > 0 when pushed from the front, and `shear`, the traction along the triangle [Pa]. */
tdm_status dem_vtp_walls(const tdm_results *results, int number, const dem_polygons *polygons, tdm_error *err);

/* scene.pvd: the files 0 … number - 1 at their times (number) [s]. */
tdm_status dem_pvd_write(const tdm_results *results, const double *times, int number, tdm_error *err);

#endif
