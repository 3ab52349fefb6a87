/* Constraints and motions of an Adams data set: JOINT, JPRIM, GCON, COUPLER, MOTION. See model.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/model.h"

#include <math.h>
#include <string.h>

/* Markers nearer than this share of their distance from the origin, or of 1 m, are one point; so are directions. */
static const double same = 1e-9;

typedef enum { NO_AXIS, Z, CROSS_XY, CROSS_ZZ } axes_kind;

enum { TURNS = 1, SLIDES = 2 }; /* coordinates */

/* A type of JOINT or JPRIM as a scene's joint; NULL: a scene has none. */
typedef struct {
  const char *name, *type;
  axes_kind axes;
  unsigned coordinates;
} joint_type;

static const joint_type joints[] = {{"REVOLUTE", "revolute", Z, TURNS},
                                    {"TRANSLATIONAL", "prismatic", Z, SLIDES},
                                    {"CYLINDRICAL", "cylindrical", Z, TURNS | SLIDES},
                                    {"SCREW", "screw", Z, TURNS | SLIDES},
                                    {"SPHERICAL", "spherical", NO_AXIS, 0},
                                    {"HOOKE", "universal", CROSS_XY, 0},
                                    {"UNIVERSAL", "universal", CROSS_ZZ, 0},
                                    {"PLANAR", "planar", Z, 0},
                                    {"FIXED", "fixed", NO_AXIS, 0},
                                    {"CONVEL", NULL, NO_AXIS, 0},
                                    {NULL, NULL, NO_AXIS, 0}};
static const joint_type primitives[] = {{"INPLANE", "point_in_plane", Z, 0},
                                        {"INLINE", "point_on_line", Z, 0},
                                        {"ATPOINT", "spherical", NO_AXIS, 0},
                                        {"PARALLEL_AXES", "parallel_axes", Z, 0},
                                        {"ORIENTATION", NULL, NO_AXIS, 0},
                                        {"PERPENDICULAR", NULL, NO_AXIS, 0},
                                        {NULL, NULL, NO_AXIS, 0}};

static const char *const joint_names[] = {"REVOLUTE",  "TRANSLATIONAL", "CYLINDRICAL", "SCREW",  "SPHERICAL", "HOOKE",
                                          "UNIVERSAL", "PLANAR",        "FIXED",       "CONVEL", "I",         "J",
                                          "PITCH",     "RACKPIN",       "PD",          NULL};
static const char *const primitive_names[] = {
    "INPLANE", "INLINE", "ATPOINT", "PARALLEL_AXES", "ORIENTATION", "PERPENDICULAR", "I", "J", NULL};

static bool near(tdm_vec3 a, tdm_vec3 b) {
  return tdm_norm(tdm_sub(a, b)) <= same * fmax(1, fmax(tdm_norm(a), tdm_norm(b)));
}

/* The first of two markers whose part moves, I before J: a body carries it. */
static int on_body(const adm_model *m, const int marker[2]) {
  return m->part[m->marker[marker[0]].part].ground ? marker[1] : marker[0];
}

/* "point" where the markers of a joint meet, else "points". */
static void add_points(adm_model *m, json_t *joint, const int marker[2]) {
  if (near(m->marker[marker[0]].pose.position, m->marker[marker[1]].pose.position))
    json_object_set_new(joint, "point", adm_place(m, on_body(m, marker), -1));
  else
    json_object_set_new(joint, "points", json_pack("[o, o]", adm_place(m, marker[1], -1), adm_place(m, marker[0], -1)));
}

/* "axis" or "axes": direction k of J and l of I, which need not be parallel where `cross`. */
static void add_axes(adm_model *m, json_t *joint, const int marker[2], int k, int l, bool cross) {
  if (!cross && near(adm_axis(&m->marker[marker[1]], k), adm_axis(&m->marker[marker[0]], l)))
    json_object_set_new(joint, "axis", adm_place(m, on_body(m, marker), k));
  else
    json_object_set_new(joint, "axes", json_pack("[o, o]", adm_place(m, marker[1], k), adm_place(m, marker[0], l)));
}

static const joint_type *find_type(const adm_reader *r, const joint_type *types) {
  for (const joint_type *t = types; t->name; t++)
    if (adm_find(r, t->name))
      return t;
  return NULL;
}

static void note_joint(adm_model *m, const adm_statement *of, const joint_type *t, const int marker[2],
                       const char *name) {
  adm_joint *j = &m->joint[m->njoint++];
  *j = (adm_joint){.of = of,
                   .marker = {marker[0], marker[1]},
                   .turns = (t->coordinates & TURNS) != 0,
                   .translates = (t->coordinates & SLIDES) != 0};
  memcpy(j->name, name, sizeof j->name);
}

tdm_status adm_add_joint(adm_model *m, const adm_statement *of, tdm_error *err) {
  const bool primitive = strcmp(of->keyword, "JPRIM") == 0;
  adm_reader r;
  int marker[2];
  char name[ADM_NAME_MAX];
  adm_open(&r, &m->dataset, of, primitive ? primitive_names : joint_names, err);
  const joint_type *t = find_type(&r, primitive ? primitives : joints);
  if (!err->status && adm_find(&r, "RACKPIN")) { /* adm_add_coupled's */
    adm_close(&r);
    return TDM_OK;
  }
  if (!err->status && !t)
    adm_fail(&m->dataset, of->line, err, "%s/%ld has no type that is known, such as %s", of->keyword, of->id,
             primitive ? "INPLANE" : "REVOLUTE");
  if (!err->status && !t->type)
    adm_leave_out(m, of, "a scene has no joint of the type %s", t->name);
  else if (!err->status && adm_read_pair(m, &r, marker) == TDM_OK) {
    const double pitch = m->units.length * adm_number(&r, "PITCH", 0);
    adm_name(of, primitive ? "primitive" : "joint", m->joints, name);
    json_t *joint = json_pack("{s:s, s:s, s:o}", "name", name, "type", t->type, "bodies", adm_bodies(m, marker));
    add_points(m, joint, marker);
    if (t->axes == Z)
      add_axes(m, joint, marker, 2, 2, false);
    else if (t->axes != NO_AXIS)
      add_axes(m, joint, marker, t->axes == CROSS_XY ? 1 : 2, t->axes == CROSS_XY ? 0 : 2, true);
    if (strcmp(t->name, "SCREW") == 0) {
      json_object_set_new(joint, "pitch", adm_real(pitch));
      if (pitch == 0)
        adm_fail(&m->dataset, of->line, err, "JOINT/%ld is a screw without PITCH, or one of zero; give it", of->id);
    }
    json_array_append_new(m->joints, joint);
    if (!primitive)
      note_joint(m, of, t, marker, name);
    if (strcmp(t->name, "FIXED") == 0 &&
        !near(tdm_quat_turn(m->marker[marker[0]].pose.orientation, m->marker[marker[1]].pose.orientation),
              tdm_v3(0, 0, 0)))
      adm_note(m, of, "keeps the orientation of the start; Adams turns I into the axes of J");
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

/* ---- GCON ---- */

/* a DM(i, j) + b = 0: the distance -b/a */
tdm_status adm_add_gcon(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {"I", "FUNCTION", NULL};
  adm_reader r;
  adm_form form = {0};
  char name[ADM_NAME_MAX];
  adm_open(&r, &m->dataset, of, names, err);
  const char *why = err->status ? NULL : adm_read_function(&r, &form);
  const adm_term *distance = NULL;
  for (int i = 0; i < form.n && !err->status && !why; i++) {
    const adm_term *t = &form.term[i];
    if (t->kind == ADM_MEASURE && t->measure == ADM_DM && t->factor != 0 && !distance)
      distance = t;
    else if (t->factor != 0 && (t->kind != ADM_POWER || t->power != 0))
      why = "is something other than the distance DM(i, j) of two markers less a number";
  }
  if (!err->status && (why || !distance))
    adm_leave_out(m, of, "its FUNCTION %s", why ? why : "has no distance DM(i, j)");
  else if (!err->status) {
    int marker[2];
    for (int k = 0; k < 2; k++)
      marker[k] = adm_find_marker(m, of, of->line, distance->marker[k], err);
    const long i = adm_id(&r, "I", false);
    if (i > 0 && i == distance->marker[1]) { /* I of the pair is the GCON's */
      const int swap = marker[0];
      marker[0] = marker[1];
      marker[1] = swap;
    }
    const double length = -m->units.length * adm_form_power(&form, 0) / distance->factor;
    if (!err->status && !(length > 0))
      adm_fail(&m->dataset, of->line, err, "GCON/%ld keeps the distance %g m; it must be greater than 0", of->id,
               length);
    adm_name(of, "rod", m->joints, name);
    if (!err->status)
      json_array_append_new(m->joints, json_pack("{s:s, s:s, s:o, s:[o, o], s:o}", "name", name, "type", "rod",
                                                 "bodies", adm_bodies(m, marker), "points", adm_place(m, marker[1], -1),
                                                 adm_place(m, marker[0], -1), "length", adm_real(length)));
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

/* ---- what couples two joints ---- */

static const adm_joint *find_joint(const adm_model *m, long id) {
  for (int i = 0; i < m->njoint; i++)
    if (m->joint[i].of->id == id)
      return &m->joint[i];
  return NULL;
}

/* Whether the data set has a JOINT of the identifier, which may have been left out. */
static bool has_joint(const adm_model *m, long id) {
  for (int i = 0; i < m->dataset.n; i++)
    if (m->dataset.statement[i].id == id && strcmp(m->dataset.statement[i].keyword, "JOINT") == 0)
      return true;
  return false;
}

static void couple(adm_model *m, const adm_statement *of, const char *type, const adm_joint *a, const adm_joint *b,
                   const char *key, double value) {
  char name[ADM_NAME_MAX];
  adm_name(of, type, m->joints, name);
  json_array_append_new(m->joints, json_pack("{s:s, s:s, s:[s, s], s:o}", "name", name, "type", type, "joints", a->name,
                                             b->name, key, adm_real(value)));
}

/* The same of any coordinates: those of translations count in metres. */
static void couple_all(adm_model *m, const adm_statement *of, const adm_joint *const j[], const bool slides[],
                       const double scale[], int n) {
  char name[ADM_NAME_MAX];
  json_t *coupled = json_array(), *coordinates = json_array(), *scales = json_array();
  for (int k = 0; k < n; k++) {
    json_array_append_new(coupled, json_string(j[k]->name));
    json_array_append_new(coordinates, json_string(slides[k] ? "translation" : "angle"));
    json_array_append_new(scales, adm_real(slides[k] ? scale[k] / m->units.length : scale[k]));
  }
  adm_name(of, "coupler", m->joints, name);
  json_array_append_new(m->joints, json_pack("{s:s, s:s, s:o, s:o, s:o}", "name", name, "type", "coupler", "joints",
                                             coupled, "coordinates", coordinates, "scales", scales));
}

/* Whether a joint's coordinate in a coupler is its translation: TYPE says T or R, else what the joint has. */
static bool translates(const adm_joint *j, const char *type, int place) {
  for (const char *p = type; p && *p; p++)
    if (strchr("TRtr", *p) && place-- == 0)
      return *p == 'T' || *p == 't';
  return j->translates;
}

/* r1 q1 + r2 q2 (+ r3 q3) = 0 of n joints' coordinates */
static void add_coupler(adm_model *m, const adm_reader *r, const adm_joint *const j[], const double scale[], int n) {
  const adm_attribute *type = adm_find(r, "TYPE");
  bool slides[ADM_IDS_MAX] = {false};
  for (int k = 0; k < n; k++) {
    slides[k] = translates(j[k], type ? type->value : NULL, k);
    if (slides[k] ? !j[k]->translates : !j[k]->turns) {
      adm_fail(r->dataset, r->of->line, r->err, "COUPLER/%ld: JOINT/%ld has no coordinate of that TYPE", r->of->id,
               j[k]->of->id);
      return;
    }
    const adm_marker *i = &m->marker[j[k]->marker[0]], *jm = &m->marker[j[k]->marker[1]];
    if (!slides[k] && fabs(adm_angle(i, jm)) > same)
      adm_note(m, r->of, "counts the angle of JOINT/%ld from the start, where its markers are %g rad apart",
               j[k]->of->id, adm_angle(i, jm));
  }
  if (n > 2 || (slides[0] && slides[1]))
    couple_all(m, r->of, j, slides, scale, n);
  else if (!slides[0] && !slides[1])
    couple(m, r->of, "gear", j[0], j[1], "ratio", scale[1] / scale[0]);
  else {
    const int turning = slides[0];
    couple(m, r->of, "rack_and_pinion", j[turning], j[!turning], "radius",
           -m->units.length * scale[turning] / scale[!turning]);
  }
}

/* The joint that has a part as one of its two and the coordinate along an axis; NULL: none. sign: 1 where the part is
 * that of I and the joint's axis points along `axis`, -1 where one of both is not so. */
static const adm_joint *joint_of_part(const adm_model *m, int part, bool turns, tdm_vec3 axis, double *sign) {
  for (int k = 0; k < m->njoint; k++) {
    const adm_joint *j = &m->joint[k];
    const int of_i = m->marker[j->marker[0]].part, of_j = m->marker[j->marker[1]].part;
    const double along = tdm_dot(adm_axis(&m->marker[j->marker[1]], 2), axis);
    if ((turns ? j->turns : j->translates) && (of_i == part || of_j == part) && fabs(along) > 1 - 1e-6) {
      *sign = (of_i == part ? 1 : -1) * (along > 0 ? 1 : -1);
      return j;
    }
  }
  return NULL;
}

/* I on the pinion, which turns about its z; J on the rack, which slides along its z. The rack rolls on the pinion where
 * it is: speed = w (z_I x n) . z_J PD/2, n from the pinion's centre to the rack. */
static void add_rack(adm_model *m, const adm_reader *r) {
  int marker[2];
  double sign[2];
  const double radius = 0.5 * m->units.length * adm_number(r, "PD", 0);
  if (adm_read_pair(m, r, marker) != TDM_OK)
    return;
  if (radius == 0) {
    adm_fail(r->dataset, r->of->line, r->err, "JOINT/%ld has no PD, the diameter of its pinion; add it", r->of->id);
    return;
  }
  const adm_marker *i = &m->marker[marker[0]], *j = &m->marker[marker[1]];
  const tdm_vec3 axis = adm_axis(i, 2), way = adm_axis(j, 2);
  const adm_joint *pinion = joint_of_part(m, i->part, true, axis, &sign[0]);
  const adm_joint *rack = joint_of_part(m, j->part, false, way, &sign[1]);
  if (!pinion || !rack) {
    adm_leave_out(m, r->of, "there is no %s",
                  pinion ? "joint along whose z its rack slides" : "joint about whose z its pinion turns");
    return;
  }
  tdm_vec3 n = tdm_sub(j->pose.position, i->pose.position);
  n = tdm_axpy(-tdm_dot(n, way), way, n);
  n = tdm_axpy(-tdm_dot(n, axis), axis, n);
  double side = tdm_dot(tdm_cross(axis, n), way);
  if (fabs(side) < 0.1 * fabs(radius)) {
    adm_note(m, r->of, "its markers do not say on which side of the pinion the rack is; check the sign of \"radius\"");
    side = 1;
  }
  couple(m, r->of, "rack_and_pinion", pinion, rack, "radius", sign[0] * sign[1] * (side > 0 ? 1 : -1) * radius);
}

/* COUPLER */
static void read_coupler(adm_model *m, const adm_reader *r) {
  const adm_statement *of = r->of;
  const adm_joint *j[ADM_IDS_MAX] = {NULL};
  long id[ADM_IDS_MAX] = {0};
  double scale[ADM_IDS_MAX] = {1, 1, 1};
  const int n = adm_ids(r, "JOINTS", 2, ADM_IDS_MAX, id);
  const int given = adm_numbers(r, "SCALES", 1, n > 0 ? n : ADM_IDS_MAX, scale);
  if (r->err->status)
    return;
  if (n == 0 || given == 0) { /* user subroutines */
    adm_leave_out(m, of, "it has no JOINTS or no SCALES");
    return;
  }
  if (n == 2 && given == 1) { /* that of the second */
    scale[1] = scale[0];
    scale[0] = 1;
  } else if (given < n) {
    adm_fail(r->dataset, of->line, r->err, "COUPLER/%ld has %d scales for %d joints; give one for each", of->id, given,
             n);
    return;
  }
  bool there = true;
  for (int k = 0; k < n && !r->err->status; k++) {
    j[k] = find_joint(m, id[k]);
    there = there && j[k];
    if (!has_joint(m, id[k]))
      adm_fail(r->dataset, of->line, r->err, "COUPLER/%ld names JOINT/%ld, which the data set does not have", of->id,
               id[k]);
    else if (scale[k] == 0)
      adm_fail(r->dataset, of->line, r->err, "COUPLER/%ld has a scale of zero; give another number", of->id);
  }
  if (!r->err->status && !there)
    adm_leave_out(m, of, "it couples a joint that is left out");
  else if (!r->err->status)
    add_coupler(m, r, j, scale, n);
}

tdm_status adm_add_coupled(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {"JOINTS", "SCALES", "TYPE", NULL};
  const bool coupler = strcmp(of->keyword, "COUPLER") == 0;
  adm_reader r;
  adm_open(&r, &m->dataset, of, coupler ? names : joint_names, err);
  const bool rack = !err->status && !coupler && adm_find(&r, "RACKPIN");
  if (!err->status && coupler)
    read_coupler(m, &r);
  else if (rack)
    add_rack(m, &r);
  if (coupler || rack) /* else adm_add_joint's */
    adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

/* ---- MOTION ---- */

/* The driver of a motion on a joint, without its law; NULL: left out, or an error. */
static json_t *joint_driver(adm_model *m, const adm_reader *r, long id, adm_law_def *def) {
  const adm_joint *j = find_joint(m, id);
  if (!has_joint(m, id))
    adm_fail(r->dataset, r->of->line, r->err, "MOTION/%ld names JOINT/%ld, which the data set does not have", r->of->id,
             id);
  else if (!j)
    adm_leave_out(m, r->of, "it moves JOINT/%ld, which is left out", id);
  else if (!j->turns && !j->translates)
    adm_leave_out(m, r->of, "it moves JOINT/%ld, which has no coordinate for it", id);
  else {
    const bool slides = adm_find(r, "TRANSLATION") || (!j->turns && !adm_find(r, "ROTATION"));
    if (slides ? !j->translates : !j->turns) {
      adm_leave_out(m, r->of, "JOINT/%ld has no coordinate of that kind", id);
      return NULL;
    }
    def->scale = slides ? m->units.length : 1;
    def->offset = slides ? 0 : -adm_angle(&m->marker[j->marker[0]], &m->marker[j->marker[1]]);
    if (slides) /* where a derivative starts from */
      def->start[0] = tdm_dot(tdm_sub(m->marker[j->marker[0]].pose.position, m->marker[j->marker[1]].pose.position),
                              adm_axis(&m->marker[j->marker[1]], 2)) /
                      m->units.length;
    else
      def->start[0] = -def->offset;
    return json_pack("{s:s, s:s}", "type", slides ? "linear_motor" : "rotational_motor", "joint", j->name);
  }
  return NULL;
}

/* The same of a motion between two markers: translation along an axis of J. */
static json_t *marker_driver(adm_model *m, const adm_reader *r, adm_law_def *def) {
  static const char *const ways[] = {"X", "Y", "Z"};
  int marker[2], k = 0;
  while (k < 3 && !adm_find(r, ways[k]))
    k++;
  if (k == 3) {
    adm_leave_out(m, r->of,
                  "it prescribes an angle of a sequence (B1, B2, B3) between two markers, which is not the "
                  "rotation that a scene's drivers prescribe");
    return NULL;
  }
  if (adm_read_pair(m, r, marker) != TDM_OK)
    return NULL;
  const adm_marker *i = &m->marker[marker[0]], *j = &m->marker[marker[1]];
  def->scale = m->units.length;
  def->start[0] = tdm_dot(tdm_sub(i->pose.position, j->pose.position), adm_axis(j, k)) / m->units.length;
  def->offset = -def->start[0];
  return json_pack("{s:s, s:o, s:o, s:o}", "type", "point_motion", "bodies", adm_bodies(m, marker), "point",
                   adm_place(m, marker[0], -1), "direction", adm_place(m, marker[1], k));
}

tdm_status adm_add_motion(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {
      "JOINT",        "ROTATION", "TRANSLATION",  "I",      "J",     "X",        "Y", "Z", "B1", "B2", "B3",
      "DISPLACEMENT", "VELOCITY", "ACCELERATION", "ICDISP", "ICVEL", "FUNCTION", NULL};
  adm_reader r;
  adm_form form = {0};
  adm_law_def def = {.time = m->units.time, .spline = m->spline, .nspline = m->nspline};
  adm_open(&r, &m->dataset, of, names, err);
  const long joint = adm_id(&r, "JOINT", false);
  const char *why = err->status ? NULL : adm_read_function(&r, &form);
  json_t *driver = NULL, *law = NULL;
  if (!err->status && !why)
    driver = joint > 0 ? joint_driver(m, &r, joint, &def) : marker_driver(m, &r, &def);
  if (driver) {
    def.derivative = adm_find(&r, "ACCELERATION") ? 2 : adm_find(&r, "VELOCITY") ? 1 : 0;
    def.start[0] = adm_number(&r, "ICDISP", def.start[0]);
    def.start[1] = adm_number(&r, "ICVEL", 0);
    law = adm_law(&form, &def, m->notes, &why);
  }
  if (why)
    adm_leave_out(m, of, "its FUNCTION %s", why);
  else if (driver && !err->status) {
    char name[ADM_NAME_MAX];
    adm_name(of, "motion", m->drivers, name);
    json_t *named = json_pack("{s:s}", "name", name);
    json_object_update(named, driver);
    json_object_set(named, "motion", law);
    json_array_append_new(m->drivers, named);
  }
  json_decref(driver);
  json_decref(law);
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}
