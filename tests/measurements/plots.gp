# Plots of hysteresis and convergence from the files of hand_measurements:
#   gnuplot -e "folder='/tmp/hand'" plots.gp        (in this folder)
set datafile separator ','
set terminal pngcairo size 900,480 font 'sans,11' background 'white'
set grid linecolor '#dddddd'

set output 'hysteresis.png'
set key outside top center horizontal
set xlabel 'commanded angle [deg]'
set ylabel 'reached minus commanded [deg]'
set label 1 'Middle joint of the index finger, 20 to 80 deg and back in 4.8 s' at graph 0.5, graph 0.95 center
set yrange [-9:9]
plot folder.'/hysteresis_index_pip_default.csv' skip 1 using 1:($2-$1) with lines lw 2 lc '#d1495b' title 'capstan friction 0.04', \
     folder.'/hysteresis_index_pip_friction_free.csv' skip 1 using 1:($2-$1) with lines lw 2 lc '#2e7d8c' title 'stiff servos (standard), no friction, 16 bit', \
     folder.'/hysteresis_index_pip_backlash.csv' skip 1 using 1:($2-$1) with lines lw 2 lc '#8a8a8a' title 'capstan friction 0.04 and 3 deg of backlash'

set output 'convergence.png'

unset label 1
set autoscale y
set key inside left top
set logscale x 2
set logscale y 10

set xlabel 'time step [ms]'
set ylabel 'difference from a step of 0.03125 ms [deg]'
set title '4 s of smooth motion of all 18 channels'
plot folder.'/convergence.csv' skip 1 using 1:3 with linespoints lw 2 pt 7 lc '#d1495b' title 'largest', \
     '' skip 1 using 1:2 with linespoints lw 2 pt 7 lc '#2e7d8c' title 'RMS', \
     [0.0625:1] 0.16*(x-0.03125) with lines dashtype 2 lc '#8a8a8a' title 'first order: proportional to step less 0.03125 ms'
