#!/bin/sh
# filmed.sh [NEVH [ADD_NOISE [SEED]]]: makes the points of
# scenes/pendulum-filmed.csv, as a film of 15 pictures a second shows the bob: an
# orbit with l = 0.874 m, g = 9.812 m/s^2, gamma = 0.035 1/s, start = 1.13 rad, and
# 4 mm of normal noise.

nevh=${1:-nevh} add_noise=${2:-add_noise}
echo "# Made by examples/filmed.sh; l = 0.874, g = 9.812, gamma = 0.035, start = 1.13"
"$nevh" run pendulum-filmed --set l=0.874,g=9.812,gamma=0.035,start=1.13 \
    --integrators gauss8 --dt 1/30 --samples 121 --quiet |
    "$add_noise" 0.004 "${3:-1}" x y
