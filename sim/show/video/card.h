#pragma once

#include <string>

#include "sim/show/video/painter.h"
#include "sim/show/video/score_board.h"

namespace gauntlet::sim {

/// Whole frames before and after the motion: what is asked, and what came out. `unit` is the size
/// of a pixel of the design at 1280 x 720.
void DrawTitleCard(Painter& painter, const Rect& frame, double unit, const std::string& title,
                   const std::string& question);
void DrawScoreBoard(Painter& painter, const Rect& frame, double unit, const std::string& title,
                    const ScoreBoard& verdict);

}  // namespace gauntlet::sim
