/* The rules that a solver is tested for, one row each. To add one: a row in the table of its file, and its test. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CONFORM_RULES_H
#define CPL_CONFORM_RULES_H

#include "coupler/session/launch.h"

/* The solver under test. Strings are borrowed. */
typedef struct {
  const char *scene;
  const char *const *set; /* NULL-terminated, may be NULL */
  const char *command;
  cpl_role role;
  cpl_solver solver[CPL_NROLE]; /* tandem's own, of which one is its partner */
  double timeout;               /* silence after which it counts as hanging [s] */
  const char *dir;              /* for sockets and logs */
  json_t *capabilities;         /* of its HELLO; NULL: not known yet */
  char software[128];           /* the same */
  int meetings;                 /* times that it was started */
  bool unready;                 /* it was not READY when that was looked at */
  void *answer;                 /* rules/mbd.c: how bodies answer to loads, owned; NULL: not asked yet */
} cpl_candidate;

typedef enum { CPL_KEPT, CPL_BROKEN, CPL_NOT_CLAIMED, CPL_NOT_SEEN } cpl_verdict_kind;

/* What came of a rule. Begins as kept. */
typedef struct {
  cpl_verdict_kind kind;
  char expected[256]; /* of a broken rule */
  char came[640];     /* the same; or why the rule could not be seen */
} cpl_verdict;

typedef struct {
  const char *name;       /* "restore.repeats" */
  const char *section;    /* of PROTOCOL.md */
  unsigned roles;         /* 1 << role that it holds for */
  const char *capability; /* that must be announced for it; NULL: it holds for all */
  const char *text;       /* a sentence */
  void (*test)(cpl_candidate *candidate, cpl_verdict *verdict);
} cpl_rule;

enum { CPL_OF_MBD = 1 << CPL_MBD, CPL_OF_DEM = 1 << CPL_DEM, CPL_OF_BOTH = CPL_OF_MBD | CPL_OF_DEM };

/* Tables, each ended by a row without a name. */
extern const cpl_rule cpl_rules_exchange[], cpl_rules_mbd[], cpl_rules_mobility[], cpl_rules_ahead[], cpl_rules_dem[],
    cpl_rules_path[], cpl_rules_proxy[], cpl_rules_gravity[], cpl_rules_state[], cpl_rules_faults[];

/* The rule is broken; printf's arguments say what came. The first fault of a rule stays. */
void cpl_broken(cpl_verdict *verdict, const char *expected, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The scene does not let the rule be seen. */
void cpl_not_seen(cpl_verdict *verdict, const char *why);

/* Has it announced a capability? */
bool cpl_claims(const cpl_candidate *candidate, const char *capability);

#endif
