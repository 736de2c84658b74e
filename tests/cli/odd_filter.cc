// A filter in a shared library: as kind exponential, with what may go wrong by its parameters.
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "controller/c_api/gauntlet_filter.h"

namespace {

struct Exponential {
  double alpha = 1.0;
  long fail_at = 0;
  long nan_at = 0;
  long samples = 0;
  std::vector<double> state;
  std::vector<bool> has_state;
};

void* Create(const gauntlet_filter_facts* facts, const char** problem) {
  auto* filter = new Exponential;
  for (int i = 0; i < facts->parameter_count; ++i) {
    const char* name = facts->parameter_names[i];
    const double value = facts->parameter_values[i];
    if (std::strcmp(name, "alpha") == 0) filter->alpha = value;
    if (std::strcmp(name, "fail_at") == 0) filter->fail_at = std::lround(value);
    if (std::strcmp(name, "nan_at") == 0) filter->nan_at = std::lround(value);
  }
  filter->state.resize(static_cast<std::size_t>(facts->channel_count));
  filter->has_state.resize(filter->state.size());
  if (filter->alpha > 0.0 && facts->rate_hz == 1000.0 &&
      std::strcmp(facts->channels[0], "index_mcp") == 0) {
    return filter;
  }
  delete filter;
  *problem = "alpha must be positive";
  return nullptr;
}

int Step(void* filter, const double* input, double* output) {
  auto& self = *static_cast<Exponential*>(filter);
  ++self.samples;
  for (std::size_t i = 0; i < self.state.size(); ++i) {
    if (!self.has_state[i]) self.state[i] = input[i];
    self.has_state[i] = true;
    self.state[i] += self.alpha * (input[i] - self.state[i]);
    output[i] = self.state[i];
  }
  if (self.samples == self.nan_at) output[0] = std::numeric_limits<double>::quiet_NaN();
  return self.samples == self.fail_at ? 3 : 0;
}

void StartChannel(void* filter, int channel) {
  static_cast<Exponential*>(filter)->has_state[static_cast<std::size_t>(channel)] = false;
}

void Destroy(void* filter) { delete static_cast<Exponential*>(filter); }

}  // namespace

const gauntlet_filter* gauntlet_filter_1(void) {
  static const gauntlet_filter kFilter = {.version = GAUNTLET_FILTER_VERSION,
                                          .create = Create,
                                          .step = Step,
                                          .start_channel = StartChannel,
                                          .destroy = Destroy};
  return &kFilter;
}
