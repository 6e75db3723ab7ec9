#include "app/errno_text.hpp"

#include <cerrno>
#include <system_error>

namespace rc10 {

std::string errnoText(int error) {
  auto text = std::generic_category().message(error);
  if (error == EMFILE) text += "; raise the limit (LimitNOFILE= of the unit, `ulimit -n`)";
  if (error == ENFILE) text += "; raise the limit of the whole computer (`sysctl fs.file-max`)";
  return text;
}

}  // namespace rc10
