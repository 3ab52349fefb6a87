/* How the normal forces of the contacts are distributed: see histogram.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/output/histogram.h"

#include "protocol/app/plot.h"
#include "protocol/scene/remark.h"

#include <stdlib.h>

#define NAME "contact_forces"
static const double most = 8; /* of f/<f> in the bins */

tdm_force_bins tdm_force_bins_of(const tdm_snapshot *s) {
  tdm_force_bins b = {.width = most / TDM_FORCE_BINS};
  double sum = 0;
  for (int k = 0; k < s->ncontact; k++)
    if (s->contact[k].force > 0) {
      sum += s->contact[k].force;
      b.n++;
    }
  if (b.n == 0)
    return b;
  b.mean = sum / (double)b.n;
  for (int k = 0; k < s->ncontact; k++) {
    const double bin = s->contact[k].force / b.mean / b.width;
    if (s->contact[k].force > 0 && bin < TDM_FORCE_BINS)
      b.density[(int)bin] += 1 / ((double)b.n * b.width);
  }
  return b;
}

tdm_status tdm_force_histogram_open(tdm_force_histogram *h, const tdm_results *results, tdm_error *err) {
  h->results = results;
  h->file = tdm_results_file(results, NAME ".csv", err);
  if (h->file)
    fputs("time [s],mean force [N],contacts,force over mean,density\n", h->file);
  return err->status;
}

tdm_status tdm_force_histogram_add(tdm_force_histogram *h, const tdm_snapshot *s, tdm_error *err) {
  const tdm_force_bins b = tdm_force_bins_of(s);
  if (b.n == 0)
    return TDM_OK;
  if (h->ntime == h->capacity) {
    int room = 2 * h->capacity + 64;
    double *time = realloc(h->time, (size_t)room * sizeof *time);
    if (!time)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the distribution of forces");
    h->time = time;
    h->capacity = room;
  }
  h->time[h->ntime++] = s->time;
  for (int k = 0; k < TDM_FORCE_BINS; k++)
    tdm_write_row(h->file, s->time, (const double[]){b.mean, (double)b.n, (k + 0.5) * b.width, b.density[k]}, 4);
  return TDM_OK;
}

void tdm_force_histogram_finish(tdm_force_histogram *h) {
  enum { CURVES = 4 };
  tdm_curve curve[CURVES];
  char using[CURVES][96], title[CURVES][64], path[4352];
  tdm_error none = {0};
  if (!h->file || h->ntime == 0)
    return;
  const bool bad = ferror(h->file);
  if (fclose(h->file) != 0 || bad)
    tdm_remark(TDM_WARNING, "contact_forces", "output.contacts", h->time[h->ntime - 1],
               "cannot write all of " NAME ".csv in %s; is the disk full?", h->results->dir);
  h->file = NULL;
  const int n = h->ntime < CURVES ? h->ntime : CURVES;
  for (int c = 0; c < n; c++) {
    const int frame = n > 1 ? (int)((long)c * (h->ntime - 1) / (n - 1)) : 0;
    snprintf(using[c], sizeof using[c], "(int(($0)/%d)==%d && $5>0 ? $4 : 1/0):5", TDM_FORCE_BINS, frame);
    snprintf(title[c], sizeof title[c], "t = %.6g s", h->time[frame]);
    curve[c] = (tdm_curve){NAME ".csv", using[c], title[c], "linespoints lw 2 pt 7 ps 0.6"};
  }
  const tdm_plot plot = {.title = "Normal forces of the contacts",
                         .xlabel = "force over the mean",
                         .ylabel = "probability density",
                         .setup = "set logscale y\n",
                         .ncurve = n,
                         .curve = curve};
  tdm_results_claim(h->results, NAME ".gp", path, sizeof path);
  tdm_results_claim(h->results, NAME ".png", path, sizeof path);
  tdm_plot_write(h->results->dir, NAME, 1, &plot, &none);
}

void tdm_force_histogram_close(tdm_force_histogram *h) {
  if (h->file)
    fclose(h->file);
  free(h->time);
  *h = (tdm_force_histogram){0};
}
