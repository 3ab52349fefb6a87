/* An FMU as a zip archive, by libzip: see pack.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/pack.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

struct cpl_pack {
  const char *file; /* borrowed */
  zip_t *zip;
};

/* The date of all entries, as zip archives have it, in no time zone: 1 January 1990, 0:00. */
enum { DOS_TIME = 0, DOS_DATE = (1990 - 1980) << 9 | 1 << 5 | 1 };

tdm_status cpl_pack_check(const char *file, bool force, tdm_error *err) {
  if (force || access(file, F_OK) != 0)
    return TDM_OK;
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s is there already; give --force to replace it, or another --out", file);
}

tdm_status cpl_pack_open(cpl_pack **pack, const char *file, bool force, tdm_error *err) {
  int why = 0;
  if (cpl_pack_check(file, force, err) != TDM_OK)
    return err->status;
  cpl_pack *p = calloc(1, sizeof *p);
  if (!p)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  p->file = file;
  p->zip = zip_open(file, ZIP_CREATE | ZIP_TRUNCATE, &why);
  *pack = p;
  if (p->zip)
    return TDM_OK;
  zip_error_t error;
  zip_error_init_with_code(&error, why);
  tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, zip_error_strerror(&error));
  zip_error_fini(&error);
  return err->status;
}

/* `source` becomes the archive's. */
static tdm_status add(cpl_pack *p, const char *name, zip_source_t *source, bool program, tdm_error *err) {
  const zip_uint32_t mode = (zip_uint32_t)(S_IFREG | (program ? 0755 : 0644)) << 16;
  const zip_int64_t index = source ? zip_file_add(p->zip, name, source, ZIP_FL_ENC_UTF_8) : -1;
  if (index >= 0 && zip_file_set_dostime(p->zip, (zip_uint64_t)index, DOS_TIME, DOS_DATE, 0) == 0 &&
      zip_file_set_external_attributes(p->zip, (zip_uint64_t)index, 0, ZIP_OPSYS_UNIX, mode) == 0 &&
      zip_set_file_compression(p->zip, (zip_uint64_t)index, ZIP_CM_DEFLATE, 1) == 0) /* quick */
    return TDM_OK;
  if (index < 0)
    zip_source_free(source);
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: the entry \"%s\" cannot be added: %s", p->file, name,
                  zip_strerror(p->zip));
}

tdm_status cpl_pack_bytes(cpl_pack *p, const char *name, const void *bytes, size_t size, tdm_error *err) {
  return add(p, name, zip_source_buffer(p->zip, bytes, size, 0), false, err);
}

tdm_status cpl_pack_file(cpl_pack *p, const char *name, const char *file, bool program, tdm_error *err) {
  struct stat is;
  if (stat(file, &is) != 0 || !S_ISREG(is.st_mode) || access(file, R_OK) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read, and is to be packed as \"%s\"", file, name);
  return add(p, name, zip_source_file(p->zip, file, 0, -1), program, err);
}

tdm_status cpl_pack_close(cpl_pack **pack, tdm_error *err) {
  cpl_pack *p = *pack;
  *pack = NULL;
  if (!p)
    return err->status;
  if (p->zip && err->status != TDM_OK)
    zip_discard(p->zip);
  else if (p->zip && zip_close(p->zip) != 0) {
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", p->file, zip_strerror(p->zip));
    zip_discard(p->zip);
  }
  free(p);
  return err->status;
}
