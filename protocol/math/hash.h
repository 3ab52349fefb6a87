/* Hashes: FNV-1a, 64 bits, by which files and states are recognised; no protection against anybody. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_MATH_HASH_H
#define TDM_MATH_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define TDM_HASH_START 0xcbf29ce484222325u

/* The hash h goes on with n bytes. */
static inline uint64_t tdm_hash_bytes(uint64_t h, const void *bytes, size_t n) {
  const unsigned char *b = bytes;
  for (size_t i = 0; i < n; i++)
    h = (h ^ b[i]) * 0x100000001b3u;
  return h;
}

/* The same by words of 8 bytes, for large blocks; n [bytes] is a multiple of 8. Another value than by bytes. */
static inline uint64_t tdm_hash_words(uint64_t h, const void *bytes, size_t n) {
  const char *b = bytes;
  uint64_t word;
  for (size_t i = 0; i < n; i += sizeof word) {
    memcpy(&word, b + i, sizeof word);
    h = (h ^ word) * 0x100000001b3u;
  }
  return h;
}

#endif
