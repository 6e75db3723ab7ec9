#include "config/yaml/yaml_reader.hpp"

#include <algorithm>
#include <exception>
#include <sstream>
#include <string>
#include <string_view>

#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "config/yaml/yaml_tree_builder.hpp"

namespace rc10 {
namespace {

/// Whether the line, counted from 1, is indented by a tab.
bool indentedByTab(std::string_view text, int line) {
  for (; line > 1 && !text.empty(); --line)
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text.substr(0, text.find_first_not_of(" \t")).find('\t') != std::string_view::npos;
}

/// The position is yaml-cpp's; where it stopped is often just after the mistake.
void reportSyntax(const YAML::Exception& thrown, std::string_view text, Problems& problems) {
  const SourcePlace place = placeOf(thrown.mark);
  if (indentedByTab(text, place.line)) {
    problems.error(place, "", "not YAML: a tab in front of this line; indent with spaces");
    return;
  }
  problems.error(place, "",
                 "not YAML: " + thrown.msg +
                     "; look here and at the line above for a missing colon, quote, bracket or space");
}

void readDocuments(std::string_view text, YamlTreeBuilder& builder, Problems& problems) {
  try {
    std::istringstream input{std::string{text}};
    YAML::Parser parser{input};
    while (!builder.failed() && parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& thrown) {
    // Beyond a limit the reason has been given; yaml-cpp's own depth guard adds nothing to it.
    if (!problems.hasErrors()) reportSyntax(thrown, text, problems);
  } catch (const std::exception& thrown) {
    problems.error({}, "", std::string{"cannot be read: "} + thrown.what());
  }
}

}  // namespace

std::optional<YamlNode> readYaml(std::string_view text, Problems& problems) {
  YamlTreeBuilder builder{problems};
  readDocuments(text, builder, problems);
  if (problems.hasErrors()) return std::nullopt;
  auto root = builder.take();
  if (!root || root->kind == YamlNode::Kind::kNull) {
    problems.error({}, "", "the document is empty; a robot needs at least 'robot' and 'buses'");
    return std::nullopt;
  }
  return root;
}

}  // namespace rc10
