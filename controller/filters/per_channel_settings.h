#pragma once

#include <functional>

#include "controller/filters/filter_config.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Calls `visit` with a visitor that shows a single number as a list where `lists` has one for it,
/// or where `visitor` has: see SettingsVisitor::ShowsList().
void VisitWithLists(SettingsVisitor& visitor, std::vector<ChannelValues>& lists,
                    const std::function<void(SettingsVisitor&)>& visit);

/// The filter of one of `channel_count` channels: every list has only its value. Errors:
/// SettingError for a list of another length, or of whole numbers that are none.
FilterSettings SettingsOfChannel(const FilterConfig& config, int channel, int channel_count);

}  // namespace gauntlet::controller
