/* What tandem-draw does while a run goes on. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_PROGRAM_ORDERS_H
#define TDM_DRAW_PROGRAM_ORDERS_H

#include <stdio.h>

/* Draw what the orders of drawer.c ask for, in the current folder, until they end; then the rows. What goes wrong is
 * said on standard error, and the frame stays. Returns the exit status. */
int draw_orders(FILE *orders);

#endif
