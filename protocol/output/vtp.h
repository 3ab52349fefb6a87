/* What there is to see for ParaView: .vtp files (VTK XML, PolyData) of each time, and the .pvd file that lists them.
 *
 *   particles_NNNNNN.vtp  the particles as points: radius, velocity, spin, id, material, force, size_class, orientation
 *   contacts_NNNNNN.vtp   where contacts are wanted: lines between centres, or from a centre to a wall, with the normal
 *                         force and the ids of both particles (-1: a wall)
 *   walls_NNNNNN.vtp      the surfaces of bodies that DEM computes with, as polygons with the index of their body;
 *                         where forces on triangles are known also `force` [N], `pressure` [Pa], > 0 when pushed
 *                         from the front, and `shear`, the traction along the triangle [Pa] (NaN elsewhere)
 *   mechanism_NNNNNN.vtp  of the others: polygons with the index of their body; bodies without a surface as vertices;
 *                         lines and dots with their number and kind; the names of all three as field data
 *   scene.pvd             all of them at their times
 *
 * Arrays stand behind the XML text as VTK's raw appended data: a 64-bit byte count and the little-endian numbers. So
 * each place in a file is known from counts alone, and processes that have a share of the particles each (view.h) write
 * into one file, each what it has, by tdm_vtp_write_share. Files hold nothing that differs between two runs of the same
 * scene.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_OUTPUT_VTP_H
#define TDM_OUTPUT_VTP_H

#include "protocol/results/results.h"
#include "protocol/view/view.h"

/* What of a scenery there are files of. */
typedef struct {
  bool particles; /* and walls: DEM takes part */
  bool mechanism; /* MBD takes part */
  bool contacts;  /* the caller wants them; tdm_vtp_parts_of leaves it false */
} tdm_vtp_parts;

tdm_vtp_parts tdm_vtp_parts_of(const tdm_scenery *scenery);

/* The files of one time. After an error none of them is left half written. With a share of the particles, all but the
 * other shares, and that file is called particles_NNNNNN.vtp.part until tdm_vtp_finish_shares, also after an error. */
tdm_status tdm_vtp_write(const tdm_results *results, int number, const tdm_scenery *scenery,
                         const tdm_snapshot *snapshot, tdm_vtp_parts parts, tdm_error *err);

/* All shares are written: the file of that number gets its name. Not whole: it is removed. */
tdm_status tdm_vtp_finish_shares(const tdm_results *results, int number, bool whole, tdm_error *err);

/* The share of another process, into DIR/particles_NNNNNN.vtp.part, which is there but for it. */
tdm_status tdm_vtp_write_share(const char *dir, int number, const tdm_snapshot *share, tdm_error *err);

/* scene.pvd, open. It grows with every time, and is whole in between. Zero-initialise; freed with tdm_pvd_close. */
typedef struct {
  FILE *file;
  long end; /* where the next entry goes [bytes] */
  int number;
} tdm_pvd;

tdm_status tdm_pvd_open(tdm_pvd *pvd, const tdm_results *results, tdm_error *err);

/* The files of the next number, at time t [s]. */
tdm_status tdm_pvd_add(tdm_pvd *pvd, const tdm_results *results, double t, tdm_vtp_parts parts, tdm_error *err);

void tdm_pvd_close(tdm_pvd *pvd);

#endif
