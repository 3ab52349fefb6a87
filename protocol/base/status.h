/* Status codes and errors.
 *
 * Anything that a user, a file or the network can cause is returned as a tdm_status, with the details in a tdm_error:
 * the place (a JSON path), the cause and the cure. A programmer's mistake is an assert. No library function exits.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_BASE_STATUS_H
#define TDM_BASE_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* one row a status: name, what it means to a user. The order is part of the protocol: append only. */
#define TDM_STATUS_LIST(X)                              \
  X(TDM_OK, "no error")                                 \
  X(TDM_ERR_ARGUMENT, "wrong command line")             \
  X(TDM_ERR_FILE, "file cannot be read or written")     \
  X(TDM_ERR_JSON, "not valid JSON")                     \
  X(TDM_ERR_SCENE, "wrong value in the scene")          \
  X(TDM_ERR_PROTOCOL, "message against the protocol")   \
  X(TDM_ERR_VERSION, "protocol version does not match") \
  X(TDM_ERR_TIMEOUT, "partner did not answer in time")  \
  X(TDM_ERR_LOST, "partner ended or cannot be reached") \
  X(TDM_ERR_NUMERIC, "the numerical solution failed")   \
  X(TDM_ERR_MEMORY, "out of memory")                    \
  X(TDM_ERR_INTERRUPTED, "interrupted")                 \
  X(TDM_ERR_LIMIT, "a verification limit was missed")   \
  X(TDM_ERR_SYSTEM, "the operating system refused")

/* What became of an operation. */
typedef enum {
#define X(name, text) name,
  TDM_STATUS_LIST(X)
#undef X
      TDM_STATUS_COUNT
} tdm_status;

enum { TDM_PATH_MAX = 256, TDM_MESSAGE_MAX = 1024 };

/* The first error of an operation. Zero-initialise before use ("= {0}"); functions never overwrite a set error. */
typedef struct {
  tdm_status status;             /* TDM_OK: no error */
  char path[TDM_PATH_MAX];       /* JSON path of the value at fault ("dem.materials[0].density"), or "" */
  char message[TDM_MESSAGE_MAX]; /* what is wrong and what to do, one line without a final newline */
} tdm_error;

/* The name ("TDM_ERR_SCENE") and the meaning of a status. Never NULL, also for numbers out of range. */
const char *tdm_status_name(tdm_status status);
const char *tdm_status_text(tdm_status status);

/* Set err unless it is set already (err may be NULL); path may be NULL. Returns the status err now holds, or `status`
 * when err is NULL, so that "return tdm_fail(...)" reads well. */
tdm_status tdm_fail(tdm_error *err, tdm_status status, const char *path, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Make a text that was cut or came from elsewhere good UTF-8, in place: a last character that is not whole is cut off,
 * bytes that are not UTF-8 become '?', control characters (a terminal's escapes, line breaks) a blank. */
void tdm_utf8_clean(char *text);

/* The candidate nearest to `word` by edit distance, or NULL when none is near (more than 1/3 of its letters differ,
 * at least 2). Candidates may contain NULL entries, which are skipped. */
const char *tdm_nearest(const char *word, const char *const *candidates, int ncandidate);

#ifdef __cplusplus
}
#endif

#endif
