/* Fingerprints: every member of the model has its row in dem/model/fields.h, and counts as the row says. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/model/fields.h"
#include "dem/store/fingerprint.h"
#include "tests/test_main.h"

/* ---- every member has a row ---- */

/* Bytes that no listed member has are padding: fewer than the alignment of what comes after them. */
static void check_gaps(const char *type, const bool *listed, const size_t *alignment, size_t size, size_t whole) {
  for (size_t k = 0, end; k < size; k = end + 1) {
    for (end = k; end < size && !listed[end];)
      end++;
    ck_assert_msg(end - k < (end < size ? alignment[end] : whole) || end == k, "byte %zu of %s belongs to no row", k,
                  type);
  }
}

static void list_bytes(bool *listed, size_t n) {
  memset(listed, true, n);
}

#define LIST_MEMBER(member, ...)                                     \
  list_bytes(listed + offsetof(looked_at, member), sizeof s.member); \
  alignment[offsetof(looked_at, member)] = _Alignof(__typeof__(s.member));
#define CHECK_GAPS(type, LIST)                                           \
  {                                                                      \
    typedef type looked_at;                                              \
    looked_at s;                                                         \
    static bool listed[sizeof s];                                        \
    static size_t alignment[sizeof s];                                   \
    LIST(LIST_MEMBER, LIST_MEMBER)                                       \
    check_gaps(#type, listed, alignment, sizeof s, _Alignof(looked_at)); \
  }

/* A member that is small enough to hide in padding is found where the compiler can tell padding: a member's bytes
 * become zero; what is not zero then, and no padding, is of a member without a row. */
#ifdef __has_builtin
#if __has_builtin(__builtin_clear_padding)
#define CLEAR(member, ...) memset(&s.member, 0, sizeof s.member);
#define CHECK_PADDING(type, LIST)                                                              \
  {                                                                                            \
    type s;                                                                                    \
    memset(&s, 0xff, sizeof s);                                                                \
    __builtin_clear_padding(&s);                                                               \
    LIST(CLEAR, CLEAR)                                                                         \
    for (size_t k = 0; k < sizeof s; k++)                                                      \
      ck_assert_msg(((const char *)&s)[k] == 0, "byte %zu of " #type " belongs to no row", k); \
  }
#endif
#endif
#ifndef CHECK_PADDING
#define CHECK_PADDING(type, LIST)
#endif

#define IS_WHOLE(type, LIST)  \
  do {                        \
    CHECK_GAPS(type, LIST)    \
    CHECK_PADDING(type, LIST) \
  } while (0)

START_TEST(test_every_member_has_a_row) {
  IS_WHOLE(dem_model, DEM_MODEL_FIELDS);
  IS_WHOLE(dem_material, DEM_MATERIAL_FIELDS);
  IS_WHOLE(dem_pair, DEM_PAIR_FIELDS);
  IS_WHOLE(dem_body, DEM_BODY_FIELDS);
  IS_WHOLE(dem_drive, DEM_DRIVE_FIELDS);
  IS_WHOLE(dem_wall, DEM_WALL_FIELDS);
  IS_WHOLE(dem_box, DEM_BOX_FIELDS);
  IS_WHOLE(dem_domain_def, DEM_DOMAIN_FIELDS);
  IS_WHOLE(dem_settling, DEM_SETTLING_FIELDS);
  IS_WHOLE(dem_group, DEM_GROUP_FIELDS);
  IS_WHOLE(dem_pouring, DEM_POURING_FIELDS);
  IS_WHOLE(dem_sizes, DEM_SIZES_FIELDS);
  IS_WHOLE(dem_source, DEM_SOURCE_FIELDS);
  IS_WHOLE(dem_sink, DEM_SINK_FIELDS);
  IS_WHOLE(dem_screening_def, DEM_SCREENING_FIELDS);
  IS_WHOLE(dem_screening_deck, DEM_DECK_FIELDS);
  IS_WHOLE(dem_trace, DEM_TRACE_FIELDS);
}
END_TEST

/* ---- each counts as its row says ---- */

static const char *const part_names[] = {
#define X(part, name) #part,
    DEM_BED_PART_LIST(X)
#undef X
};

/* Another value of a member changes the fingerprints that it should, and no others. */
static void look(const dem_model *m, void *member, const char *name, const char *of) {
  uint64_t before[DEM_BED_PARTS], after[DEM_BED_PARTS], whole = dem_fingerprint_whole(m);
  dem_fingerprint_bed_parts(m, before);
  *(char *)member ^= 1;
  dem_fingerprint_bed_parts(m, after);
  ck_assert_msg((whole != dem_fingerprint_whole(m)) == (of != NULL), "%s", name);
  *(char *)member ^= 1;
  ck_assert_msg(whole == dem_fingerprint_whole(m), "%s", name);
  for (int p = 0; p < DEM_BED_PARTS; p++) {
    const char *part = of && strcmp(of, "PLACED") == 0 ? "SHAPES" : of;
    bool counts = part && (strcmp(part, part_names[p]) == 0 || (strcmp(part, "EACH") == 0 && before[p] != after[p]));
    ck_assert_msg((before[p] != after[p]) == counts, "%s: %s", name, part_names[p]);
  }
}

/* pointers are not followed when they have another value */
#define OF_STRUCT(member, how, part)                                                \
  if (strcmp(#how, "SHAPE") && strcmp(#how, "SHAPE_DATA") && strcmp(#how, "DECKS")) \
    look(m, &s->member, #member, #part);
#define FREE_OF_STRUCT(member, why)                          \
  if (strcmp(#member, "wanted") && strcmp(#member, "given")) \
    look(m, &s->member, #member, NULL);
#define COUNTS(type, at, LIST)      \
  {                                 \
    type *s = at;                   \
    LIST(OF_STRUCT, FREE_OF_STRUCT) \
  }

static void *pointed(const void *pointer) {
  void *to;
  memcpy(&to, pointer, sizeof to);
  return to;
}

/* numbers of the model that count no array; particles by the first */
#define OF_MODEL(member, how, part)                                                                      \
  if (strcmp(#how, "PARTICLES") == 0)                                                                    \
    look(m, pointed(&m->member), #member, #part);                                                        \
  else if (strcmp(#how, "BYTES") == 0 || strcmp(#how, "TAIL") == 0 || strcmp(#how, "MULTI_STEP") == 0 || \
           (strcmp(#how, "NUMBER") == 0 && (#member[0] != 'n' || strcmp(#member, "nload") == 0)))        \
    look(m, &m->member, #member, #part);
#define FREE_OF_MODEL(member, why)                                                             \
  if (#member[0] != 'n' && strcmp(#member, "driven") != 0 && strcmp(#member, "geometry") != 0) \
    look(m, &m->member, #member, NULL);

/* bodies, some driven, a box that is open and periodic, groups, sources and sinks, a deck, a path */
static json_t *flowing(void) {
  return scene_json(
      "{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],'pairs':[{'materials':['a',"
      "'a'],'restitution':0.5,'friction':0.4}],"
      "'bodies':[{'name':'b','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]},{'name':'c','material':'a',"
      "'motion':{'velocity':[1,0,0]},'shapes':[{'type':'box','side':'outside','size':[0.2,0.2,0.1],'center':[0.5,0.5,0]"
      "}]}],'domain':{'min':[0,0,-1],'max':[1,1,1],'x':'periodic'},"
      "'particles':[{'type':'list','material':'a','radius':0.04,'positions':[[0.8,0.8,0.05]],'force':[1,0,0]}],"
      "'sources':[{'name':'s','material':'a','radius':[0.01,0.03],'rate':400,'region':{'min':[0,0,0.9],'max':[1,1,0.95]"
      "}}],'sinks':[{'name':'k','type':'box','min':[0.3,0.3,0],'max':[0.35,0.35,1],'classes':[0.02,0.035]}],"
      "'screening':{'decks':[{'name':'d','outlets':['k']}]},'paths':[{'name':'p','particle':0}]}");
}

/* a bed that is poured and pressed */
static json_t *settling(void) {
  return scene_json(
      "{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],'pairs':[{'materials':['a',"
      "'a'],'restitution':0.5,'friction':0.4}],'bodies':[{'name':'b','material':'a','shapes':[{'type':'box','side':"
      "'inside','size':[0.4,0.4,1],'lid':{'face':'+z','gap':0.01}}]}],'settle':{'max_time':1},'particles':[{'type':"
      "'poured','material':'a','count':10,'radius':[0.03,0.04],'region':{'min':[-0.2,-0.2,0.2],'max':[0.2,0.2,0.4]}}]"
      "}");
}

START_TEST(test_members_count) {
  rig *r = rig_make(flowing(), 1e-4, 0, NULL);
  dem_model *m = r->model;
  ck_assert(m->nwall >= 2 && m->ngroup == 1 && m->nsource == 1 && m->nsink == 1 && m->domain.wanted);
  DEM_MODEL_FIELDS(OF_MODEL, FREE_OF_MODEL)
  COUNTS(dem_material, &m->material[0], DEM_MATERIAL_FIELDS)
  COUNTS(dem_body, &m->body[1], DEM_BODY_FIELDS)
  COUNTS(dem_drive, &m->body[1].drive, DEM_DRIVE_FIELDS)
  COUNTS(dem_wall, &m->wall[1], DEM_WALL_FIELDS)
  COUNTS(dem_domain_def, &m->domain, DEM_DOMAIN_FIELDS)
  COUNTS(dem_settling, &m->settle, DEM_SETTLING_FIELDS)
  COUNTS(dem_group, &m->group[0], DEM_GROUP_FIELDS)
  COUNTS(dem_source, &m->source[0], DEM_SOURCE_FIELDS)
  COUNTS(dem_sizes, &m->source[0].sizes, DEM_SIZES_FIELDS)
  COUNTS(dem_sink, &m->sink[0], DEM_SINK_FIELDS)
  COUNTS(dem_screening_def, &m->screening, DEM_SCREENING_FIELDS)
  COUNTS(dem_screening_deck, &m->screening.deck[0], DEM_DECK_FIELDS)
  COUNTS(dem_trace, &m->trace[0], DEM_TRACE_FIELDS)
  rig_free(r);
}
END_TEST

/* the pairs of the settle phase are the bed's, those of the run the run's; a lid's place is not the bed's */
START_TEST(test_members_of_a_bed_count) {
  rig *r = rig_make(settling(), 1e-4, 0, NULL);
  dem_model *m = r->model;
  ck_assert(m->nbox == 1 && m->npouring == 1 && m->box[0].lid >= 0);
  COUNTS(dem_pouring, &m->pouring[0], DEM_POURING_FIELDS)
  look(m, &m->box[0].gap, "gap", "SHAPES");
  look(m, &m->box[0].press, "press", "SHAPES");
  look(m, &m->wall[m->box[0].lid].point, "lid", NULL);
#undef OF_STRUCT
#define OF_STRUCT(member, how, part) look(m, &s->member, #member, "PAIRS");
  COUNTS(dem_pair, &m->settle_pair[0], DEM_PAIR_FIELDS)
#undef OF_STRUCT
#define OF_STRUCT(member, how, part) look(m, &s->member, #member, "RUN");
  COUNTS(dem_pair, &m->pair[0], DEM_PAIR_FIELDS)
  rig_free(r);
}
END_TEST

TEST_MAIN("dem fingerprint", test_every_member_has_a_row, test_members_count, test_members_of_a_bed_count)
