#include "config/yaml/yaml_tree_builder.hpp"

#include <string_view>
#include <utility>

#include "config/yaml/yaml_reader.hpp"

namespace rc10 {
namespace {

// Tags that yaml-cpp reports for a value without one: "?" for plain ones, lists and maps, "!" for quoted
// ones.
constexpr std::string_view kPlainTag = "?";
constexpr std::string_view kQuotedTag = "!";

YamlNode makeNode(YamlNode::Kind kind, const YAML::Mark& mark, const std::string& tag) {
  YamlNode node;
  node.kind = kind;
  node.place = placeOf(mark);
  node.in_quotes = tag == kQuotedTag;
  if (tag != kPlainTag && tag != kQuotedTag) node.tag = tag;
  return node;
}

std::size_t sizeOf(const YamlNode& node) {
  std::size_t nodes = 1;
  for (const auto& item : node.items) nodes += sizeOf(item);
  for (const auto& entry : node.entries) nodes += sizeOf(entry.key) + sizeOf(entry.value);
  return nodes;
}

}  // namespace

SourcePlace placeOf(const YAML::Mark& mark) noexcept {
  return mark.is_null() ? SourcePlace{} : SourcePlace{mark.line + 1, mark.column + 1};
}

std::optional<YamlNode> YamlTreeBuilder::take() {
  return failed_ ? std::nullopt : std::exchange(root_, std::nullopt);
}

void YamlTreeBuilder::OnDocumentStart(const YAML::Mark& mark) {
  if (++documents_ == 2) stop(placeOf(mark), "a second document begins here; keep one robot in a file");
}

void YamlTreeBuilder::OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) {
  if (count(mark, 1)) add(makeNode(YamlNode::Kind::kNull, mark, std::string{kPlainTag}), anchor);
}

void YamlTreeBuilder::OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) {
  const auto found = anchors_.find(anchor);
  if (found == anchors_.end())
    return stop(placeOf(mark), "this alias stands inside its own anchor; write the value out");
  if (count(mark, sizeOf(found->second))) add(found->second, 0);
}

void YamlTreeBuilder::OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                               const std::string& value) {
  if (!count(mark, 1)) return;
  auto node = makeNode(YamlNode::Kind::kScalar, mark, tag);
  node.text = value;
  if (value.size() > YamlLimits::kTextBytes) {
    return stop(node.place, "a text of " + std::to_string(value.size()) + " bytes; at most " +
                                std::to_string(YamlLimits::kTextBytes) + " are accepted");
  }
  add(std::move(node), anchor);
}

void YamlTreeBuilder::OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                                      YAML::EmitterStyle::value /*style*/) {
  if (count(mark, 1)) begin(makeNode(YamlNode::Kind::kList, mark, tag), anchor);
}

void YamlTreeBuilder::OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                                 YAML::EmitterStyle::value /*style*/) {
  if (count(mark, 1)) begin(makeNode(YamlNode::Kind::kMap, mark, tag), anchor);
}

void YamlTreeBuilder::begin(YamlNode node, YAML::anchor_t anchor) {
  if (open_.size() == YamlLimits::kDepth) {
    return stop(node.place,
                "nested more than " + std::to_string(YamlLimits::kDepth) + " deep; a configuration needs 6");
  }
  open_.push_back({std::move(node), anchor, std::nullopt});
}

void YamlTreeBuilder::end() {
  if (failed_) return;
  Open done = std::move(open_.back());
  open_.pop_back();
  add(std::move(done.node), done.anchor);
}

void YamlTreeBuilder::add(YamlNode node, YAML::anchor_t anchor) {
  if (anchor != 0) anchors_[anchor] = node;
  if (open_.empty()) {
    root_ = std::move(node);
    return;
  }
  Open& parent = open_.back();
  if (parent.node.kind == YamlNode::Kind::kList) {
    parent.node.items.push_back(std::move(node));
  } else if (!parent.key) {
    parent.key = std::move(node);
  } else {
    // An empty value has no place of its own: yaml-cpp gives that of whatever follows.
    if (node.kind == YamlNode::Kind::kNull) node.place = parent.key->place;
    parent.node.entries.push_back({std::move(*parent.key), std::move(node)});
    parent.key.reset();
  }
}

bool YamlTreeBuilder::count(const YAML::Mark& mark, std::size_t nodes) {
  if (failed_) return false;
  nodes_ += nodes;
  if (nodes_ <= YamlLimits::kNodes) return true;
  stop(placeOf(mark), "more than " + std::to_string(YamlLimits::kNodes) +
                          " values, an alias counted as all it stands for; this is no configuration");
  return false;
}

void YamlTreeBuilder::stop(SourcePlace place, std::string reason) {
  if (!failed_) problems_.error(place, "", std::move(reason));
  failed_ = true;
}

}  // namespace rc10
