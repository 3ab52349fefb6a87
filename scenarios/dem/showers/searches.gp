# What bench_searches prints, as README.md shows it: gnuplot searches.gp
# SPDX-License-Identifier: GPL-3.0-or-later
set terminal pngcairo size 1100,430 font "sans,10"
set output "searches.png"
set multiplot layout 1,2
set logscale xy
set xlabel "discs"
set ylabel "time of a run of 4 s, 400 000 steps [s]"
set xrange [200:20000]
set key top left reverse Left
set grid
of(name) = sprintf("< grep '^%s ' searches.txt", name)
plot of("verlet-1967") using 2:4 with linespoints lw 1.5 title "verlet-1967", \
     of("linked-linear") using 2:4 with linespoints lw 1.5 title "linked-linear", \
     of("auto") using 2:4 with linespoints lw 1.5 title "tandem's own (auto)"
unset logscale
unset grid
set xlabel " "
set ylabel "share of a step, 4336 discs [%]"
set xrange [-0.6:2.6]
set yrange [0:118]
set ytics 0,20,100
set style data histograms
set style histogram rowstacked
set style fill solid 0.8 border -1
set boxwidth 0.6
set key top horizontal center
at = "< awk '$2 == 4336 && $1 != \"sweep\"' searches.txt"
plot at using ($5 + $6):xtic(1) title "lists", "" using 7 title "forces", "" using 8 title "integration"
