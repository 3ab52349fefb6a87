/* A frame that several processes write: see share.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/output/share.h"

#include "protocol/output/vtp.h"
#include "protocol/view/frames.h"

tdm_status tdm_share_write(const tdm_shared_frame *f, const tdm_snapshot *share, tdm_error *err) {
  char path[4352];
  if (share->nparticle == 0)
    return TDM_OK;
  snprintf(path, sizeof path, "%s/%s", f->dir, TDM_FRAMES_FILE);
  if (tdm_vtp_write_share(f->dir, f->number, share, err) == TDM_OK)
    tdm_frames_write_share(path, share, f->arrays, err);
  return err->status;
}
