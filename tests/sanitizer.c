/* How AddressSanitizer behaves in tandem's programs, unless ASAN_OPTIONS says otherwise. */
/* SPDX-License-Identifier: GPL-3.0-or-later */

const char *__asan_default_options(void);

/* handle_sigill: undefined behaviour traps; with this the line of the source is printed before the process ends.
 * exitcode: none that tandem's programs give, so that no test takes what was found for a refusal of wrong input.
 * quarantine_size_mb: what was freed is used again after so much; with 256, the default, runs take ever new pages. */
const char *__asan_default_options(void) {
  return "handle_sigill=1:exitcode=99:quarantine_size_mb=32";
}
