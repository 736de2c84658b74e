#include "sim/tables/message_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

class JoinedFiles : public MessageFile {
 public:
  explicit JoinedFiles(std::vector<std::unique_ptr<MessageFile>> parts) : parts_(std::move(parts)) {
    for (const auto& part : parts_) {
      is_cut_ = is_cut_ || part->is_cut();
      for (const Topic& topic : part->topics()) Add(topic);
    }
  }

  void ForEachMessage(std::size_t topic, const Visit& visit) override {
    for (const auto& part : parts_) {
      const auto& topics = part->topics();
      const auto found = std::ranges::find(topics, topics_[topic].name, &Topic::name);
      if (found != topics.end()) part->ForEachMessage(found - topics.begin(), visit);
    }
  }

 private:
  void Add(const Topic& topic) {
    const auto [place, is_new] = by_name_.try_emplace(topic.name, topics_.size());
    if (is_new) {
      topics_.push_back(topic);
      return;
    }
    Topic* const known = &topics_[place->second];
    if (known->type != topic.type || known->encoding != topic.encoding ||
        known->schema != topic.schema) {
      throw UserError(fmt::format("has several types of messages in the topic {}: {} and {}",
                                  OneLine(topic.name, 60), OneLine(known->type, 60),
                                  OneLine(topic.type, 60)));
    }
    if (topic.messages == 0) return;
    known->first_ns =
        known->messages == 0 ? topic.first_ns : std::min(known->first_ns, topic.first_ns);
    known->last_ns = known->messages == 0 ? topic.last_ns : std::max(known->last_ns, topic.last_ns);
    known->messages += topic.messages;
  }

  std::vector<std::unique_ptr<MessageFile>> parts_;
  std::map<std::string, std::size_t> by_name_;
};

}  // namespace

std::unique_ptr<MessageFile> JoinMessageFiles(std::vector<std::unique_ptr<MessageFile>> parts) {
  return std::make_unique<JoinedFiles>(std::move(parts));
}

}  // namespace gauntlet::sim
