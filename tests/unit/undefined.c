/* Undefined behaviour, which the sanitizers must name: a shift by as many bits as an int has. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdio.h>

int main(int argc, char **argv) {
  (void)argv;
  printf("%d\n", 1 << (31 + argc));
  return 0;
}
