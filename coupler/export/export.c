/* `tandem export fmu`: see export.h.
 *
 *   modelDescription.xml              what the FMU has (describe.h)
 *   binaries/PLATFORM/NAME.so         the binary (guest/), which this program carries in itself
 *   resources/scene.json, files/      the scene, resolved, and the files that it names
 *   resources/fmu.json                side, token, variables; of dem the bodies as mbd told them
 *   resources/bin/                    tandem-serve and tandem's solvers
 *   documentation/licenses/           tandem's licence, and where the source is
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/export.h"

#include "coupler/export/describe.h"
#include "coupler/export/pack.h"
#include "coupler/export/scene_files.h"
#include "coupler/export/serve/stage.h"
#include "protocol/app/find.h"
#include "protocol/math/hash.h"
#include "protocol/version.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Files that this program carries in itself: the binary, as the build has made it, and the licence
 * (coupler/CMakeLists.txt). */
#define CARRY(symbol, file)                                                                                       \
  __asm__(".pushsection .rodata,\"a\"\n.global " #symbol "\n" #symbol ":\n.incbin \"" file "\"\n.global " #symbol \
          "_end\n" #symbol "_end:\n.byte 0\n.popsection\n");                                                      \
  extern const char symbol[], symbol##_end[]
CARRY(cpl_guest_binary, CPL_GUEST);
CARRY(cpl_license, CPL_LICENSE);

static const char source_note[] =
    "The programs of this FMU that are called tandem are version " TDM_VERSION " of tandem, under the GNU General\n"
    "Public License, version 3 or later (license.txt). Their source is that of this version of tandem, from where\n"
    "tandem itself came. Whoever hands this FMU on sees to it that those who get it can have the source, too.\n";

typedef struct {
  const cpl_export_options *options;
  cpl_export_side side;
  int version;
  char name[64]; /* of the model and its binary: a C identifier */
  char file[4096];
  cpl_stage stage;
  cpl_scene_files files;
  cpl_export_variable *variable;
  int nvariable;
  char token[40];
  char *description, *scene, *facts; /* texts; owned */
} export;

/* ---- options ---- */

/* "spring_damper" for scenarios/spring_damper/scene.json, "mill" for mill.json; blanks and the like become _. */
static void choose_name(export *x) {
  char path[4096];
  snprintf(path, sizeof path, "%s", x->options->scene);
  char *real = realpath(path, NULL);
  snprintf(path, sizeof path, "%s", real ? real : x->options->scene);
  free(real);
  char *dot = strrchr(path, '.'), *last = strrchr(path, '/');
  if (dot && (!last || dot > last))
    *dot = 0;
  if (last && strcmp(last, "/scene") == 0) {
    *last = 0;
    last = strrchr(path, '/');
  }
  const char *base = last ? last + 1 : path;
  snprintf(x->name, sizeof x->name, "%s%.60s", isdigit((unsigned char)*base) || !*base ? "_" : "", base);
  for (char *c = x->name; *c; c++)
    *c = isalnum((unsigned char)*c) && (unsigned char)*c < 0x80 ? *c : '_';
}

static tdm_status read_options(export *x, tdm_error *err) {
  const cpl_export_options *o = x->options;
  int side = 0;
  while (side < CPL_NEXPORT && strcmp(o->side ? o->side : "dem", cpl_export_sides[side]) != 0)
    side++;
  if (side == CPL_NEXPORT)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "export: --side %s: give \"dem\", \"mbd\" or \"both\"", o->side);
  x->side = (cpl_export_side)side;
  if (o->version && strcmp(o->version, "2") != 0 && strcmp(o->version, "3") != 0)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "export: --fmi %s: give 2 or 3, the version of the standard",
                    o->version);
  x->version = o->version ? atoi(o->version) : 2;
  choose_name(x);
  if (o->out)
    snprintf(x->file, sizeof x->file, "%s", o->out);
  else
    snprintf(x->file, sizeof x->file, "%s.fmu", x->name);
  return TDM_OK;
}

/* ---- texts ---- */

static cpl_description describe(const export *x) {
  const cpl_settings *s = &x->stage.settings;
  const cpl_session *session = &x->stage.session;
  bool needs_tool = false;
  for (int r = 0; r < CPL_NROLE; r++)
    needs_tool = needs_tool || (cpl_export_has(x->side, (cpl_role)r) && s->command[r]);
  const long n = s->adapt.on ? (long)(1 + 1e-3 / s->dt) : s->n; /* where windows choose their length, about 1 ms */
  return (cpl_description){
      .version = x->version,
      .identifier = x->name,
      .name = x->name,
      .title = json_string_value(json_object_get(x->stage.scene.root, "title")),
      .needs_tool = needs_tool,
      .restores = x->stage.restores,
      .derives = x->side != CPL_EXPORT_DEM && session->mobility.Y,
      .has_flag = x->side == CPL_EXPORT_DEM,
      .end = s->time_end,
      .window = (double)n * s->dt,
      .dt = x->side == CPL_EXPORT_MBD ? 0 : s->dt,
      .variable = x->variable,
      .nvariable = x->nvariable,
  };
}

/* The bodies of mbd's READY, in place of a multibody solver. */
static json_t *told_bodies(export *x) {
  json_t *bodies = json_deep_copy(x->stage.session.bodies), *body;
  size_t i;
  json_array_foreach(bodies, i, body) {
    const char *mesh = json_string_value(json_object_get(body, "mesh"));
    if (mesh)
      json_object_set_new(body, "mesh", json_string(cpl_scene_files_name(&x->files, mesh)));
  }
  return bodies;
}

static json_t *make_facts(export *x) {
  const cpl_export_layout l = cpl_export_layout_of(x->side, &x->stage.session);
  json_t *starts = json_array();
  for (int i = 0; i < cpl_export_ninput(&l); i++)
    json_array_append_new(starts, json_real(x->variable[i].start));
  json_t *facts = json_pack("{s:s, s:i, s:i, s:i, s:b, s:o, s:O}", "side", cpl_export_sides[x->side], "inputs",
                            cpl_export_ninput(&l), "outputs", cpl_export_noutput(&l), "outputs_of_a_body", l.output,
                            "mobility", x->side != CPL_EXPORT_DEM && x->stage.session.mobility.Y != NULL, "starts",
                            starts, "files", x->files.files);
  if (facts && x->side == CPL_EXPORT_DEM)
    json_object_set_new(facts, "bodies", told_bodies(x));
  return facts;
}

/* The programs that are packed; returns their number, 1 + CPL_NROLE at most. */
static int list_programs(const export *x, const char *name[1 + CPL_NROLE]) {
  int n = 0;
  name[n++] = "tandem-serve";
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_export_has(x->side, (cpl_role)r) && !x->stage.settings.command[r])
      name[n++] = x->options->solver[r].executable;
  return n;
}

static tdm_status find_program(char *path, size_t size, const char *name, tdm_error *err) {
  return tdm_find_program(path, size, name)
             ? TDM_OK
             : tdm_fail(err, TDM_ERR_FILE, NULL, "%s is neither beside this program nor on PATH; install it", name);
}

static void hash_bytes(uint64_t h[2], const void *bytes, size_t n) {
  for (int k = 0; k < 2; k++)
    h[k] = tdm_hash_bytes(h[k], bytes, n);
}

static tdm_status hash_file(uint64_t h[2], const char *path, tdm_error *err) {
  char block[1 << 16];
  size_t n;
  FILE *f = fopen(path, "rb");
  while (f && (n = fread(block, 1, sizeof block, f)) > 0)
    hash_bytes(h, block, n);
  const bool failed = !f || ferror(f);
  if (f)
    fclose(f);
  return failed ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read, and is to be packed", path) : TDM_OK;
}

/* The same contents have the same token, others another one: of texts, files, programs. */
static tdm_status make_token(export *x, tdm_error *err) {
  const char *const texts[] = {x->description, x->scene, x->facts};
  const char *program[1 + CPL_NROLE], *file;
  char path[4096];
  json_t *name;
  uint64_t h[2] = {TDM_HASH_START, ~TDM_HASH_START};
  const int nprogram = list_programs(x, program);
  for (int i = 0; i < 3; i++)
    hash_bytes(h, texts[i], strlen(texts[i]));
  hash_bytes(h, cpl_guest_binary, (size_t)(cpl_guest_binary_end - cpl_guest_binary));
  json_object_foreach(x->files.source, file, name) {
    if (hash_file(h, file, err) != TDM_OK)
      return err->status;
  }
  for (int i = 0; i < nprogram; i++)
    if (find_program(path, sizeof path, program[i], err) != TDM_OK || hash_file(h, path, err) != TDM_OK)
      return err->status;
  snprintf(x->token, sizeof x->token, "{%08x-%04x-%04x-%04x-%012llx}", (unsigned)(h[0] >> 32),
           (unsigned)(h[0] >> 16) & 0xffff, (unsigned)h[0] & 0xffff, (unsigned)(h[1] >> 48),
           (unsigned long long)h[1] & 0xffffffffffff);
  return TDM_OK;
}

static tdm_status write_texts(export *x, tdm_error *err) {
  const size_t how = JSON_INDENT(1) | JSON_REAL_PRECISION(17) | JSON_SORT_KEYS;
  cpl_description d = describe(x);
  d.title = d.title ? d.title : "";
  json_t *facts = make_facts(x);
  x->scene = json_dumps(x->files.scene, how);
  x->facts = json_dumps(facts, how);
  x->description = cpl_describe(&d);
  if (facts && x->scene && x->facts && x->description && make_token(x, err) == TDM_OK) {
    json_object_set_new(facts, "token", json_string(x->token));
    d.token = x->token;
    free(x->facts);
    free(x->description);
    x->facts = json_dumps(facts, how);
    x->description = cpl_describe(&d);
  }
  json_decref(facts);
  return err->status != TDM_OK || (x->scene && x->facts && x->description)
             ? err->status
             : tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
}

/* ---- the archive ---- */

static tdm_status pack_program(cpl_pack *pack, const char *name, tdm_error *err) {
  char path[4096], entry[128];
  if (find_program(path, sizeof path, name, err) != TDM_OK)
    return err->status;
  snprintf(entry, sizeof entry, "resources/bin/%s", name);
  return cpl_pack_file(pack, entry, path, true, err);
}

static tdm_status pack_all(const export *x, cpl_pack *pack, tdm_error *err) {
  char entry[256];
  const char *file, *program[1 + CPL_NROLE];
  json_t *name;
  snprintf(entry, sizeof entry, "binaries/%s/%s.so", x->version == 2 ? CPL_PLATFORM2 : CPL_PLATFORM3, x->name);
  cpl_pack_bytes(pack, "modelDescription.xml", x->description, strlen(x->description), err);
  if (err->status == TDM_OK)
    cpl_pack_bytes(pack, entry, cpl_guest_binary, (size_t)(cpl_guest_binary_end - cpl_guest_binary), err);
  if (err->status == TDM_OK)
    cpl_pack_bytes(pack, "resources/scene.json", x->scene, strlen(x->scene), err);
  if (err->status == TDM_OK)
    cpl_pack_bytes(pack, "resources/fmu.json", x->facts, strlen(x->facts), err);
  json_object_foreach(x->files.source, file, name) {
    snprintf(entry, sizeof entry, "resources/%.200s", json_string_value(name));
    if (err->status == TDM_OK)
      cpl_pack_file(pack, entry, file, false, err);
  }
  const int nprogram = list_programs(x, program);
  for (int i = 0; i < nprogram && err->status == TDM_OK; i++)
    pack_program(pack, program[i], err);
  if (err->status == TDM_OK)
    cpl_pack_bytes(pack, "documentation/licenses/license.txt", cpl_license, (size_t)(cpl_license_end - cpl_license),
                   err);
  if (err->status == TDM_OK)
    cpl_pack_bytes(pack, "documentation/licenses/source.txt", source_note, strlen(source_note), err);
  return err->status;
}

/* ---- the command ---- */

static void print_export(const export *x) {
  const cpl_settings *s = &x->stage.settings;
  const cpl_export_layout l = cpl_export_layout_of(x->side, &x->stage.session);
  const cpl_description d = describe(x);
  static const char *const whats[] = {"the particles: motions of the bodies in, loads on them out",
                                      "the bodies: loads on them in, motions out",
                                      "particles and bodies: further loads on the bodies in, motions out"};
  printf("%s: FMI %d.0 co-simulation, %s\n", x->file, x->version, whats[x->side]);
  printf("  %-28s %d, of %d coupled bod%s\n", "inputs", cpl_export_ninput(&l), l.nbody, l.nbody == 1 ? "y" : "ies");
  printf("  %-28s %d, of them %d channels\n", "outputs", cpl_export_noutput(&l),
         l.nchannel[CPL_MBD] + l.nchannel[CPL_DEM]);
  if (d.dt > 0)
    printf("  %-28s multiples of %g s (time.dt); proposed: %g s\n", "communication steps", d.dt, d.window);
  else
    printf("  %-28s of any length; proposed: %g s\n", "communication steps", d.window);
  printf("  %-28s %s\n", "saves and restores states", d.restores ? "yes" : "no");
  printf("  %-28s %s\n", "directional derivatives", d.derives ? "yes: accelerations by loads" : "no");
  if (d.needs_tool)
    for (int r = 0; r < CPL_NROLE; r++)
      if (cpl_export_has(x->side, (cpl_role)r) && s->command[r])
        printf("  %-28s \"%s\" as %s is not packed\n", "needs, installed there", s->command[r], cpl_role_names[r]);
  for (size_t i = 0; i < json_array_size(x->stage.session.warnings); i++) {
    const json_t *w = json_array_get(x->stage.session.warnings, i);
    fprintf(stderr, "tandem: warning: %s: %s\n", json_string_value(json_object_get(w, "path")),
            json_string_value(json_object_get(w, "message")));
  }
}

static tdm_status make(export *x, tdm_error *err) {
  const char *const programs[CPL_NROLE] = {x->options->solver[CPL_MBD].executable,
                                           x->options->solver[CPL_DEM].executable};
  const unsigned roles = 1u << CPL_MBD | (cpl_export_has(x->side, CPL_DEM) ? 1u << CPL_DEM : 0);
  cpl_pack *pack = NULL;
  if (cpl_stage_load(&x->stage, x->side, roles, x->options->scene, x->options->set, err) != TDM_OK)
    return err->status;
  x->stage.talks = true;
  if (cpl_stage_start(&x->stage, roles, programs, err) != TDM_OK ||
      cpl_scene_files_make(&x->files, x->side, x->stage.scene.root, err) != TDM_OK) {
    tdm_scene_locate(&x->stage.scene, err);
    return err->status;
  }
  x->variable = cpl_export_variables(x->side, &x->stage.session, &x->nvariable, err);
  if (!x->variable || write_texts(x, err) != TDM_OK)
    return err->status;
  if (cpl_pack_open(&pack, x->file, x->options->force, err) == TDM_OK)
    pack_all(x, pack, err);
  return cpl_pack_close(&pack, err);
}

tdm_status cpl_export_fmu(const cpl_export_options *options, tdm_error *err) {
  export x = {.options = options};
  if (read_options(&x, err) == TDM_OK && cpl_pack_check(x.file, options->force, err) == TDM_OK &&
      make(&x, err) == TDM_OK)
    print_export(&x);
  if (x.stage.open)
    cpl_stage_stop(&x.stage, err);
  cpl_stage_free(&x.stage);
  cpl_scene_files_free(&x.files);
  free(x.variable);
  free(x.description);
  free(x.scene);
  free(x.facts);
  return err->status;
}
