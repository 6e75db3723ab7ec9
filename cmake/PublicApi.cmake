# Headers of librc10, for programs that embed rc10d with families and modules of their own: docs/adding-a-motor.md and
# docs/adding-a-module.md. All others are internal. The list is closed: tests/layers/check_public_api.py.

# Whole layers: algorithms, buses, what a motor, a module and a simulated drive are made of.
set(RC10_PUBLIC_LAYERS app bus motor module sim)

set(RC10_PUBLIC_HEADERS
  config/client_config.hpp
  config/gpio_config.hpp
  config/load_config.hpp
  config/module_types.hpp
  config/motor_families.hpp
  config/robot_config.hpp
  config/yaml/problem.hpp
  daemon/daemon_main.hpp
  drives/families.hpp
  drives/recogniser.hpp
  drives/wording.hpp)
