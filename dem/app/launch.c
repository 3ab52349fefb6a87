/* The processes of MPI: see launch.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/launch.h"

#include "dem/base/ranks.h"
#include "protocol/app/command_line.h"
#include "protocol/app/find.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char program[] = "tandem-dem-mpi", option[] = "--ranks";
static char **words; /* NULL-terminated */
static bool asked;   /* the command line says how many */

int dem_launched_processes(void) {
  const char *open_mpi = getenv("OMPI_COMM_WORLD_SIZE"), *others = getenv("PMI_SIZE");
  return open_mpi ? atoi(open_mpi) : others ? atoi(others) : 0;
}

/* where the option --ranks stands from word k on; argc: nowhere */
static int find_option(int k, int argc, char **argv) {
  while (k < argc && strcmp(argv[k], option) != 0)
    k++;
  return k;
}

int dem_launch_words(int *argc, char **argv, tdm_error *err) {
  int k = find_option(1, *argc, argv), n = 0;
  words = argv;
  if (k == *argc)
    return 0;
  asked = true;
  if (find_option(k + 1, *argc, argv) < *argc) {
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s is there twice; give it once", option);
    return 0;
  }
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

bool dem_launch_wanted(int ranks) {
  return ranks > 1 && words && !asked && dem_launched_processes() == 0;
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
 * to ranks: other programs have the same ones, and a rank may have several threads. Ranks that are told to end get some
 * seconds to keep what was computed; under a server, which ends a run by messages, mpirun ends ranks only where one was
 * lost, and the server is to know soon. */
static void allow(int ranks) {
  const bool root = geteuid() == 0;
  bool server = false;
  for (int k = 1; words && words[k]; k++)
    server = server || strcmp(words[k], "--connect") == 0;
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  if (root) {
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 0);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 0);
  }
  setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 0);
  setenv("OMPI_MCA_hwloc_base_binding_policy", "none", 0);
  setenv("OMPI_MCA_odls_base_sigkill_timeout", server ? "1" : "5", 0);
  if (root || ranks > cores)
    fprintf(stderr, "tandem-dem: notice: mpirun -n %d%s%s\n", ranks, root ? ", as root" : "",
            ranks > cores ? ", on fewer cores: ranks take turns, and wait for each other" : "");
}

/* A file that can be read only once: mpirun's processes cannot read it again, and have another standard input. */
static tdm_status refuse_stream(const char *place, tdm_error *err) {
  struct stat is;
  for (int k = 1; words && words[k]; k++)
    if (strcmp(words[k], "/dev/stdin") == 0 || strncmp(words[k], "/dev/fd/", 8) == 0 ||
        (stat(words[k], &is) == 0 && S_ISFIFO(is.st_mode)))
      return tdm_fail(err, TDM_ERR_ARGUMENT, place,
                      "%s can be read only once, but several processes start with the command line anew; write it to a "
                      "file",
                      words[k]);
  return TDM_OK;
}

/* What mpirun must not have of this process: a standard input, which it would read to its end, and, where the server
 * lets no Ctrl-C come to its solvers, the terminal's Ctrl-C, which mpirun would end the ranks for. */
static void part_from_terminal(void) {
  struct sigaction interrupt;
  const int null = open("/dev/null", O_RDONLY);
  if (null >= 0) {
    dup2(null, 0);
    close(null);
  }
  if (sigaction(SIGINT, NULL, &interrupt) == 0 && interrupt.sa_handler == SIG_IGN)
    setpgid(0, 0);
}

tdm_status dem_launch_ranks(int ranks, const char *place, tdm_error *err) {
  char mpirun[4096], path[4096], number[16];
  int n = 0;
  if (ranks > DEM_RANKS_MAX)
    return tdm_fail(err, TDM_ERR_SCENE, place, "is %d but must be at most %d", ranks, DEM_RANKS_MAX);
  if (refuse_stream(place, err))
    return err->status;
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
  part_from_terminal();
  become(mpirun, argv, err);
  free(argv);
  return err->status;
}
