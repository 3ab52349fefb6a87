/* The time histories of a result directory, gathered for reading: by what they belong to (a body, a joint, the
 * particles, the exchange ...), and there by quantity, the components of a vector together.
 *
 *   channel   a column of a CSV file
 *   panel     channels that one plot shows
 *   section   the panels of a body, a joint ...
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CONTENTS_CONTENTS_H
#define CPL_CONTENTS_CONTENTS_H

#include "coupler/results/table.h"
#include "protocol/base/status.h"

#include <jansson.h>
#include <stdbool.h>

/* What sections are an index's headings of, in its order. */
typedef enum {
  CPL_BODIES,
  CPL_JOINTS,
  CPL_DRIVERS,
  CPL_FORCES,
  CPL_MECHANISM,
  CPL_PARTICLES,
  CPL_FLOW,
  CPL_SCREENING,
  CPL_PATHS,
  CPL_EXCHANGE,
  CPL_OTHERS,
  CPL_NGROUP
} cpl_group;

typedef enum {
  CPL_VARIES,
  CPL_CONSTANT,
  CPL_ROUND_OFF, /* changes by no more than round-off beside others of its unit */
  CPL_NO_NUMBER  /* in no row */
} cpl_course;

typedef struct {
  char name[128];         /* "joint.lift.fx" */
  char unit[48];          /* as in the file */
  char component[96];     /* what tells it from others of its panel: "x" */
  int table, column;      /* where it is */
  double start, end;      /* first and last number */
  double least, greatest; /* of all finite ones */
  cpl_course course;
} cpl_channel;

enum { CPL_PANEL_CHANNELS = 6 };

typedef struct {
  char quantity[128]; /* "angular velocity" */
  char unit[48];
  bool vector;
  int table, section;
  int nchannel;
  int channel[CPL_PANEL_CHANNELS]; /* (nchannel) of the contents */
} cpl_panel;

typedef struct {
  cpl_group group;
  char name[128]; /* "lift", "energy" */
  int npanel;     /* of the contents' panels; those of one section need not stand together */
} cpl_section;

typedef struct {
  int ntable, nchannel, npanel, nsection;
  cpl_table *table; /* (ntable) */
  cpl_channel *channel;
  cpl_panel *panel;
  cpl_section *section; /* in the order of the index */
  int nlack;
  char (*lack)[512]; /* (nlack) what could not be read, and why */
} cpl_contents;

/* Read the files of `dir` that a run of this scene writes; scene and summary may be NULL:
 * without a scene the bodies are those whose files are there. Files that are not there are
 * left out, those that cannot be read are in `lack`. cpl_contents_free afterwards in any case. */
tdm_status cpl_contents_read(cpl_contents *c, const char *dir, const json_t *scene, const json_t *summary,
                             tdm_error *err);
void cpl_contents_free(cpl_contents *c);

/* "Bodies" */
const char *cpl_group_title(cpl_group group);
/* "body left", into out (size bytes). Returns out. */
const char *cpl_section_title(const cpl_section *section, char *out, size_t size);

/* Some channel of the panel varies. */
bool cpl_panel_varies(const cpl_contents *c, const cpl_panel *panel);

#endif
