# Plots of hysteresis and convergence from the files of hand_measurements:
#   gnuplot -e "folder='/tmp/hand'" plots.gp        (in this folder)
set datafile separator ','
set terminal pngcairo size 900,480 font 'sans,11' background 'white'
set grid linecolor '#dddddd'

set output 'hysteresis.png'
set key outside bottom center horizontal
set xlabel 'commanded angle [deg]'
set ylabel 'reached minus commanded [deg]'
set title 'Middle joint of the index finger, 20 to 80 deg and back in 4.8 s'
plot folder.'/hysteresis_index_pip_default.csv' skip 1 using 1:($2-$1) with lines lw 2 lc '#d1495b' title 'capstan friction 0.03', \
     folder.'/hysteresis_index_pip_friction_free.csv' skip 1 using 1:($2-$1) with lines lw 2 lc '#2e7d8c' title 'no friction, no dead band, 16 bit', \
     folder.'/hysteresis_index_pip_backlash.csv' skip 1 using 1:($2-$1) with lines lw 2 lc '#8a8a8a' title 'capstan friction 0.03 and 3 deg of backlash'

set output 'convergence.png'

set key inside left top
set logscale x 2
set logscale y 10

set xlabel 'time step [ms]'
set ylabel 'difference from a step of 0.03125 ms [deg]'
set title '4 s of smooth motion of all 18 channels'
plot folder.'/convergence.csv' skip 1 using 1:3 with linespoints lw 2 pt 7 lc '#d1495b' title 'largest', \
     '' skip 1 using 1:2 with linespoints lw 2 pt 7 lc '#2e7d8c' title 'RMS', \
     [0.06:1] 0.067*x with lines dashtype 2 lc '#8a8a8a' title 'first order'
