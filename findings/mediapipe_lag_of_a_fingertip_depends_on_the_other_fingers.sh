#!/bin/bash
# mediapipe 0.10.21 (PyPI): LandmarksSmoothingCalculator with a one_euro_filter, whose value scaling is on by default.
#
# Guess: each coordinate has a filter of its own, so that one fingertip with the same motion has the same lag, whatever
# the other fingers do.
# Seen: the speed is divided by the size of the box around all landmarks. A fingertip moves by 20 mm in 0.33 s, at the same
# times in the same place; half way, at 10 mm, the filter is at 6.9 mm for an open hand (180 mm) and at 8.6 mm for a fist
# (60 mm). beta is so in Hz per hand size / s. With disable_value_scaling it is at 4.9 mm for both.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q --disable-pip-version-check install mediapipe==0.10.21
"$folder/venv/bin/python" - 2>/dev/null <<'PYTHON'
import mediapipe as mp
from mediapipe.framework.formats import landmark_pb2

GRAPH = """
input_stream: "landmarks"
output_stream: "smoothed"
node {
  calculator: "LandmarksSmoothingCalculator"
  input_stream: "LANDMARKS:landmarks"
  output_stream: "FILTERED_LANDMARKS:smoothed"
  options { [mediapipe.LandmarksSmoothingCalculatorOptions.ext] { one_euro_filter { %s } } }
}"""

def half_way_mm(hand_m, options):
    """Filtered place of the fingertip when it is at 10 mm."""
    graph, places = mp.CalculatorGraph(graph_config=GRAPH % options), []
    graph.observe_output_stream("smoothed", lambda _, packet: places.append(mp.packet_getter.get_proto(packet).landmark[0].x))
    graph.start_run()
    for i in range(26):
        landmarks = landmark_pb2.LandmarkList()
        fingertip_m = 0.02 * min(max((i - 20) / 10, 0), 1)
        for x in (fingertip_m, -hand_m / 2, hand_m / 2):  # two other fingertips are the ends of the hand
            landmarks.landmark.add(x=x, y=x, z=0)
        graph.add_packet_to_input_stream("landmarks", mp.packet_creator.create_proto(landmarks).at(i * 33333))
    graph.close_all_packet_sources()
    graph.wait_until_done()
    return 1000 * places[-1]

settings = "min_cutoff: 1 beta: 10 derivate_cutoff: 1"
opened, fist = half_way_mm(0.18, settings), half_way_mm(0.06, settings)
fixed = [half_way_mm(hand_m, settings + " disable_value_scaling: true") for hand_m in (0.18, 0.06)]
print(f"open hand {opened:.2f} mm, fist {fist:.2f} mm; without scaling {fixed[0]:.2f} and {fixed[1]:.2f} mm")
assert abs(opened - 6.87) < 0.01 and abs(fist - 8.55) < 0.01, "the lag no longer depends on the other fingers"
assert abs(fixed[0] - fixed[1]) < 1e-4
PYTHON
