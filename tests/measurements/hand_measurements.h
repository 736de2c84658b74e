#pragma once

#include <filesystem>

namespace gauntlet::sim::testing {

/// The numbers of docs/evidence/hand.md, measured; each prints to stdout.
void PrintJoints();
void PrintCoupling();
void PrintOpposition();
void PrintFriction();
void PrintReach();
void PrintSteps();
void PrintClosing();
void PrintDelays();
void PrintServos();
void PrintJointLoop();
void PrintSlack();
void PrintWarnings();
void PrintSpeed();

/// Files for pictures, into `folder`.
void WriteHysteresis(const std::filesystem::path& folder);
void WriteConvergence(const std::filesystem::path& folder);
void WritePictures(const std::filesystem::path& folder);

}  // namespace gauntlet::sim::testing
