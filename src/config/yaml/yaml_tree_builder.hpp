#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/mark.h>

#include "config/yaml/problem.hpp"
#include "config/yaml/yaml_node.hpp"

namespace rc10 {

/// yaml-cpp counts from 0 and has a mark of -1 for "nowhere".
[[nodiscard]] SourcePlace placeOf(const YAML::Mark& mark) noexcept;

/// Turns yaml-cpp's events into a YamlNode. Its own Node would keep the first of two equal keys and
/// lose quotes; the events still have everything. Stops adding when a limit is reached.
class YamlTreeBuilder : public YAML::EventHandler {
 public:
  explicit YamlTreeBuilder(Problems& problems) : problems_(problems) {}

  /// The first document, if it was complete and within the limits.
  [[nodiscard]] std::optional<YamlNode> take();
  /// A limit was reached, or a second document began: the rest need not be read.
  [[nodiscard]] bool failed() const noexcept { return failed_; }

  void OnDocumentStart(const YAML::Mark& mark) override;
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override;
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override;
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override;
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override;
  void OnMapEnd() override { end(); }

 private:
  /// A list or map that has begun and not yet ended.
  struct Open {
    YamlNode node;
    YAML::anchor_t anchor = 0;
    std::optional<YamlNode> key;  ///< Key of a map: read, its value is still to come.
  };

  void begin(YamlNode node, YAML::anchor_t anchor);
  void end();
  void add(YamlNode node, YAML::anchor_t anchor);
  [[nodiscard]] bool count(const YAML::Mark& mark, std::size_t nodes);
  void stop(SourcePlace place, std::string reason);

  Problems& problems_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, YamlNode> anchors_;
  std::optional<YamlNode> root_;
  std::size_t nodes_ = 0;
  int documents_ = 0;
  bool failed_ = false;
};

}  // namespace rc10
