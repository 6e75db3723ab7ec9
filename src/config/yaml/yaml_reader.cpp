#include "config/yaml/yaml_reader.hpp"

#include <exception>
#include <sstream>
#include <string>

#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "config/yaml/yaml_tree_builder.hpp"

namespace rc10 {
namespace {

/// The position is yaml-cpp's; where it stopped is often just after the mistake.
void reportSyntax(const YAML::Exception& thrown, Problems& problems) {
  problems.error(placeOf(thrown.mark), "",
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
    if (!problems.hasErrors()) reportSyntax(thrown, problems);
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
