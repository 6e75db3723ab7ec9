#include "bus/interface_names.hpp"

#include <net/if.h>

#include <memory>
#include <vector>

#include "app/nearest.hpp"

namespace rc10 {

std::string similarInterface(std::string_view name) {
  const std::unique_ptr<struct if_nameindex, decltype(&::if_freenameindex)> all{::if_nameindex(),
                                                                                &::if_freenameindex};
  std::vector<std::string_view> names;
  for (const auto* each = all.get(); each != nullptr && each->if_index != 0; ++each)
    names.emplace_back(each->if_name);
  return didYouMean(name, names);
}

std::string adviceForMissing(std::string_view name) {
  return similarInterface(name) + "; `ip link` lists what there is. A HAT needs its device tree overlay";
}

}  // namespace rc10
