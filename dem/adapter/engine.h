/* What an engine is made of: dem.h is its interface. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_ADAPTER_ENGINE_H
#define DEM_ADAPTER_ENGINE_H

#include "dem/adapter/report.h"
#include "dem/channels/channels.h"
#include "dem/dem.h"
#include "dem/output/view.h"
#include "dem/proxy/proxy.h"

struct dem_engine {
  dem_model *model;
  dem_data *data;
  tdm_participant *participant; /* borrowed; NULL: no server */
  dem_proxy *proxy;
  double contact_time; /* the shortest that is expected [s] */
  tdm_wrench *load;    /* (ncoupled) at the start; then sums over the window */
  dem_channels channels;
  double *initial; /* (channels.count) */
  double *before;  /* (channels.count) at the beginning of a step that an output time lies inside of */
  dem_report report;
  dem_start start;
  dem_view view;                 /* what is remembered for those who look */
  double time;                   /* end of the last window [s] */
  dem_data *slot[TDM_SLOTS_MAX]; /* states that were saved; NULL: none */
  bool turned[TDM_SLOTS_MAX];    /* with them: dem_proxy_turned */
};

/* Refuse integrators that cannot carry a mechanism. */
tdm_status dem_engine_check_proxy(const dem_engine *engine, tdm_error *err);

#endif
