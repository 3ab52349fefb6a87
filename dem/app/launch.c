/* The processes of MPI: see launch.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/launch.h"

#include "dem/base/ranks.h"
#include "protocol/app/command_line.h"
#include "protocol/app/find.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char program[] = "tandem-dem-mpi";
static char **words; /* NULL-terminated */

int dem_launched_processes(void) {
  const char *open_mpi = getenv("OMPI_COMM_WORLD_SIZE"), *others = getenv("PMI_SIZE");
  return open_mpi ? atoi(open_mpi) : others ? atoi(others) : 0;
}

int dem_launch_words(int *argc, char **argv, tdm_error *err) {
  static const char option[] = "--ranks";
  int k = 1, n = 0;
  words = argv;
  while (k < *argc && strcmp(argv[k], option) != 0)
    k++;
  if (k == *argc)
    return 0;
  const char *value = k + 1 < *argc ? argv[k + 1] : "";
  if (*value && strlen(value) < 9 && strspn(value, "0123456789") == strlen(value))
    n = atoi(value);
  if (n < 1 || n > DEM_RANKS_MAX) {
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s needs a number of processes, 1 to %d, not \"%s\"", option, DEM_RANKS_MAX,
             value);
    return 0;
  }
  *argc -= 2;
  for (; k <= *argc; k++) /* with the NULL at the end */
    argv[k] = argv[k + 2];
  return n;
}

static tdm_status find(char *path, size_t size, const char *name, const char *place, const char *package,
                       tdm_error *err) {
  if (tdm_find_program(path, size, name))
    return TDM_OK;
  return tdm_fail(err, TDM_ERR_FILE, place,
                  "several processes need %s, which is neither beside this program nor on PATH; install %s, or take "
                  "one process, with dem.threads",
                  name, package);
}

static tdm_status become(const char *path, char *const *argv, tdm_error *err) {
  tdm_release_signals();
  execv(path, argv);
  return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "%s cannot be executed: %s", path, strerror(errno));
}

static tdm_status find_program(char *path, size_t size, const char *place, tdm_error *err) {
  return find(path, size, program, place, "libopenmpi-dev, configure and build again", err);
}

tdm_status dem_launch_become(tdm_error *err) {
  char path[4096];
  return find_program(path, sizeof path, NULL, err) ? err->status : become(path, words, err);
}

/* What a user of mpirun must ask for, and here has asked for; who has set something else keeps it. Cores are not given
 * to ranks: other programs have the same ones, and a rank may have several threads. Ranks that are told to end get the
 * time to keep what was computed [s]. */
static void allow(int ranks) {
  const bool root = geteuid() == 0;
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  if (root) {
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 0);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 0);
  }
  setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 0);
  setenv("OMPI_MCA_hwloc_base_binding_policy", "none", 0);
  setenv("OMPI_MCA_odls_base_sigkill_timeout", "5", 0);
  if (root || ranks > cores)
    fprintf(stderr, "tandem-dem: notice: mpirun -n %d%s%s\n", ranks, root ? ", as root" : "",
            ranks > cores ? ", on fewer cores: ranks take turns, and wait for each other" : "");
}

tdm_status dem_launch_ranks(int ranks, const char *place, tdm_error *err) {
  char mpirun[4096], path[4096], number[16];
  int n = 0;
  if (ranks > DEM_RANKS_MAX)
    return tdm_fail(err, TDM_ERR_SCENE, place, "is %d but must be at most %d", ranks, DEM_RANKS_MAX);
  if (find_program(path, sizeof path, place, err) || find(mpirun, sizeof mpirun, "mpirun", place, "openmpi-bin", err))
    return err->status;
  while (words && words[n])
    n++;
  char **argv = calloc((size_t)n + 4, sizeof *argv);
  if (!argv)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  snprintf(number, sizeof number, "%d", ranks);
  argv[0] = mpirun, argv[1] = "-n", argv[2] = number, argv[3] = path;
  for (int k = 1; k < n; k++)
    argv[3 + k] = words[k];
  allow(ranks);
  become(mpirun, argv, err);
  free(argv);
  return err->status;
}
